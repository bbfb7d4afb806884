/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The memory of a mind's CLIPS.  Blocks of one kind share pages; what is larger than a page is a
 * block of malloc's.  All pages and large blocks stand in lists: a mind gives back everything at
 * once, whatever CLIPS is doing.
 */
#include "mind/engine/engine.h"

#include <malloc.h>
#include <stdlib.h>

enum {
    HEAP_STEP = 8,                      /* bytes from one size to the next */
    HEAP_FREE = HEAP_SIZES * HEAP_STEP, /* bytes that cost no units */
    HEAP_WORK = 1024,                   /* the port hears of work at so many allocations */
    HEAP_MUCH = 8 << 20                 /* more than most minds have */
};

/* Stands before each large block, and begins each page. */
struct heap_item {
    struct heap_item *next, **link; /* link: what points to it */
#ifdef __SANITIZE_ADDRESS__
    size_t bytes, none; /* what is given back has the size that it was taken with */
#endif
};

struct heap_page {
    _Alignas(HEAP_STEP) struct heap_item item; /* as the blocks behind it */
    void *free;              /* blocks that were given back, each of which points to the next */
    uint32_t used, cut, end; /* blocks in use; bytes cut from the page so far, and at most */
    uint32_t number;         /* HEAP_KNOWN: it has none */
};

enum { HEAP_ROOM = PAGE_BYTES - sizeof(struct heap_page) };
_Static_assert(HEAP_ROOM % HEAP_STEP == 0 && HEAP_ROOM / (HEAP_FREE + HEAP_STEP) == HEAP_PARTS,
               "a kind for each number of parts");

/* The address sanitizer sees each block: none shares a page. */
#ifdef __SANITIZE_ADDRESS__
enum { HEAP_SHARED_MAX = 0 };
#else
enum { HEAP_SHARED_MAX = HEAP_ROOM };
#endif

/* Of a block that shares a page: its size, or in how many parts of that size a page is cut. */
static size_t heap_kind(size_t bytes)
{
    size_t steps = bytes > 0 ? (bytes + HEAP_STEP - 1) / HEAP_STEP : 1;
    return bytes > HEAP_FREE ? HEAP_SIZES + HEAP_ROOM / (steps * HEAP_STEP) - 1 : steps - 1;
}

static uint32_t heap_size(size_t kind)
{
    size_t most = kind < HEAP_SIZES ? (kind + 1) * HEAP_STEP : HEAP_ROOM / (kind - HEAP_SIZES + 1);
    return (uint32_t)(most - most % HEAP_STEP);
}

/* The mind whose environment is being made. */
static struct mind *heap_maker;

static struct mind *heap_mind(void *env)
{
    struct mind *m = env ? environment_mind(env) : NULL;
    return m ? m : heap_maker;
}

static void heap_link(struct heap_item **list, struct heap_item *item)
{
    item->next = *list;
    item->link = list;
    if (item->next) {
        item->next->link = &item->next;
    }
    *list = item;
}

static void heap_unlink(struct heap_item *item)
{
    *item->link = item->next;
    if (item->next) {
        item->next->link = item->link;
    }
}

static uint32_t heap_number(struct heap *h, void *page, uint32_t size)
{
    uint32_t number = h->spares > 0 ? h->spare[--h->spares] : h->numbers;
    if (number < HEAP_KNOWN) {
        h->known[number] = page;
        h->numbers += number == h->numbers;
    }
    h->shape = (h->shape + size) * 0x9e3779b97f4a7c15;
    return number;
}

static struct heap_page *heap_open(struct heap *h, struct heap_item **list, uint32_t size)
{
    struct heap_page *page = pages_take();
    if (!page) {
        return NULL;
    }
    uint32_t blocks = (uint32_t)HEAP_ROOM / size;
    *page = (struct heap_page){.cut = sizeof *page,
                               .end = (uint32_t)sizeof *page + blocks * size,
                               .number = heap_number(h, page, size)};
    heap_link(list, &page->item);
    return page;
}

static bool heap_is_full(const struct heap_page *page)
{
    return !page->free && page->cut == page->end;
}

static void *heap_take_shared(struct heap *h, size_t bytes)
{
    size_t kind = heap_kind(bytes);
    struct heap_page *page = (struct heap_page *)h->pages[kind];
    if (!page) {
        page = heap_open(h, &h->pages[kind], heap_size(kind));
    }
    if (!page) {
        return NULL;
    }
    void *block = page->free;
    if (block) {
        page->free = *(void **)block;
    } else {
        block = (char *)page + page->cut;
        page->cut += heap_size(kind);
    }
    page->used++;
    if (heap_is_full(page)) {
        heap_unlink(&page->item);
        heap_link(&h->full, &page->item);
    }
    return block;
}

static void heap_give_shared(struct heap *h, void *block, size_t bytes)
{
    struct heap_page *page = (struct heap_page *)((uintptr_t)block - (uintptr_t)block % PAGE_BYTES);
    bool full = heap_is_full(page);
    *(void **)block = page->free;
    page->free = block;
    page->used--;
    if (full || page->used == 0) {
        heap_unlink(&page->item);
    }
    if (page->used == 0) {
        if (page->number < HEAP_KNOWN) {
            h->known[page->number] = NULL;
            h->spare[h->spares++] = (uint16_t)page->number;
        }
        pages_give(page);
    } else if (full) {
        heap_link(&h->pages[heap_kind(bytes)], &page->item);
    }
}

void *heap_take(void *env, size_t bytes)
{
    struct mind *m = heap_mind(env);
    struct heap *h = &m->heap;
    bool fits = bytes <= BUDGET_MEMORY_BURST && h->held + bytes <= BUDGET_MEMORY_BURST;
    if (!fits && state_is_limited(m)) {
        return NULL;
    }
    void *block = NULL;
    if (bytes <= HEAP_SHARED_MAX) {
        block = heap_take_shared(h, bytes);
    } else {
        struct heap_item *item = malloc(sizeof *item + bytes);
        if (item) {
#ifdef __SANITIZE_ADDRESS__
            item->bytes = bytes;
#endif
            heap_link(&h->large, item);
            block = item + 1;
        }
    }
    m->cost.units += bytes > HEAP_FREE ? bytes / BUDGET_UNITS_A_TICK : 0; /* it is filled */
    h->held += block ? bytes : 0;
    if (state_is_limited(m) && ++m->allocations % HEAP_WORK == 0) {
        engine_work(m);
    }
    return block;
}

void heap_give(void *env, void *block, size_t bytes)
{
    struct heap *h = &heap_mind(env)->heap;
    h->held -= bytes;
    if (bytes <= HEAP_SHARED_MAX) {
        heap_give_shared(h, block, bytes);
    } else {
        struct heap_item *item = (struct heap_item *)block - 1;
#ifdef __SANITIZE_ADDRESS__
        MU_ASSERT(item->bytes == bytes);
#endif
        heap_unlink(item);
        free(item);
    }
}

void heap_make(struct mind *m)
{
    heap_maker = m;
    m->env = CreateEnvironment();
    MU_ASSERT(m->env);
    SetEnvironmentContext(m->env, m);
    heap_maker = NULL;
}

static void heap_drop_list(struct heap_item *item, void (*give)(void *))
{
    while (item) {
        struct heap_item *next = item->next;
        give(item);
        item = next;
    }
}

void heap_drop(struct mind *m)
{
    struct heap *h = &m->heap;
    bool much = h->held > HEAP_MUCH;
    m->env = NULL;
    prefetch_forget(m);
    heap_drop_list(h->large, free);
    heap_drop_list(h->full, pages_give);
    for (size_t i = 0; i < HEAP_SIZES + HEAP_PARTS; i++) {
        heap_drop_list(h->pages[i], pages_give);
    }
    *h = (struct heap){.held = 0};
    if (much) {
        (void)malloc_trim(0); /* else it keeps some of it */
    }
}
