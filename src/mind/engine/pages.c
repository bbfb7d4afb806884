/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Pages for the minds of a process, from chunks of the kernel's.  A step goes through all minds and
 * touches few lines in many pages of each, so that finding the pages takes as long as the lines: a
 * chunk may be one page of the processor's, but for the first, which minds that are few do not
 * fill.
 */
#include "mind/engine/engine.h"

#include <sys/mman.h>

enum {
    CHUNK_BYTES = 2 << 20
}; /* a chunk stands at a multiple of its size, and begins with this: */

struct chunk {
    struct chunk *next, **link; /* link: what points to it, if it has room */
    void *free;                 /* pages that were given back, each of which points to the next */
    uint32_t used, cut;         /* pages in use; bytes cut from it so far */
};

static struct chunk *chunks_with_room;
static uint32_t chunks;

static bool chunk_is_full(const struct chunk *c)
{
    return !c->free && c->cut == CHUNK_BYTES;
}

static void chunk_link(struct chunk *c)
{
    c->next = chunks_with_room;
    c->link = &chunks_with_room;
    if (c->next) {
        c->next->link = &c->next;
    }
    chunks_with_room = c;
}

static void chunk_unlink(struct chunk *c)
{
    *c->link = c->next;
    if (c->next) {
        c->next->link = c->link;
    }
}

/* @return a chunk in the list; NULL: there is no memory */
static struct chunk *chunk_open(void)
{
    char *at =
        mmap(NULL, 2 * CHUNK_BYTES, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) {
        return NULL;
    }
    size_t before = CHUNK_BYTES - (uintptr_t)at % CHUNK_BYTES;
    (void)munmap(at, before);
    if (before < CHUNK_BYTES) {
        (void)munmap(at + before + CHUNK_BYTES, CHUNK_BYTES - before);
    }
    struct chunk *c = (struct chunk *)(at + before);
    if (chunks++ > 0) {
        (void)madvise(c, CHUNK_BYTES, MADV_HUGEPAGE); /* slower without */
    }
    *c = (struct chunk){.cut = PAGE_BYTES};
    chunk_link(c);
    return c;
}

uint32_t pages_chunks(void)
{
    return chunks;
}

void *pages_take(void)
{
    struct chunk *c = chunks_with_room ? chunks_with_room : chunk_open();
    if (!c) {
        return NULL;
    }
    void *page = c->free;
    if (page) {
        c->free = *(void **)page;
    } else {
        page = (char *)c + c->cut;
        c->cut += PAGE_BYTES;
    }
    c->used++;
    if (chunk_is_full(c)) {
        chunk_unlink(c);
    }
    return page;
}

void pages_give(void *page)
{
    struct chunk *c = (struct chunk *)((uintptr_t)page - (uintptr_t)page % CHUNK_BYTES);
    bool full = chunk_is_full(c);
    *(void **)page = c->free;
    c->free = page;
    c->used--;
    bool is_spare = chunks_with_room == c && !c->next; /* kept: a page more may come and go */
    if (c->used == 0 && !full && !is_spare) {
        chunk_unlink(c);
        (void)munmap(c, CHUNK_BYTES);
        chunks--;
    } else if (full) {
        chunk_link(c);
    }
}
