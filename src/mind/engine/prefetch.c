/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A step of one of many minds waits for memory most of the time: it needs some 500 lines of the
 * cache, from which the other minds have driven them meanwhile.  They are nearly the same ones in
 * every step, and in minds of the same rules they stand in the same places of their heaps; so they
 * are asked for at once when a step begins.  Which ones they are, the cache itself tells: the pages
 * of one mind are flushed, it makes its step, and the lines that are quick to read then were used.
 *
 * Nothing depends on it but time.
 */
#include "mind/engine/engine.h"

#include <string.h>

enum {
    LINE_BYTES = 64,
    SHAPES = 16,          /* different rules in a process; minds of more are as they were */
    MEASURE_FIRST = 16,   /* steps of each mind before the first measurement, */
    MEASURE_AGAIN = 1024, /* and from one to the next */
    NEAR_TICKS = 50       /* more than the second cache takes, less than the third */
};

/* What minds whose heaps have grown alike use in a step. */
struct prefetch {
    uint64_t shape;
    uint32_t minds;             /* of that shape; 0: it is free */
    uint64_t steps, measured;   /* of all of them: so far; until the last measurement, 0: none */
    uint32_t first;             /* of the lines that are measured next: 0 even ones, 1 odd ones */
    const struct mind *by;      /* whose step is measured now, or NULL */
    uint64_t lines[HEAP_KNOWN]; /* of each page, a bit for each line */
};

static struct prefetch prefetches[SHAPES];

/* --- lines ------------------------------------------------------------------------------------ */

#ifdef __x86_64__
#include <x86intrin.h>

enum { CHUNKS_MIN = 16 }; /* the cache has what fewer minds would ask for */

static void line_flush(const char *line)
{
    _mm_clflush(line);
}

static uint64_t ticks(void)
{
    _mm_lfence();
    uint64_t now = __rdtsc();
    _mm_lfence();
    return now;
}
#else /* no program can flush a line, or no clock is fast enough */
enum { CHUNKS_MIN = INT32_MAX };

static void line_flush(const char *line)
{
    (void)line;
}

static uint64_t ticks(void)
{
    return 0;
}
#endif

static void line_read(const volatile char *line)
{
    (void)*line;
}

static uint64_t line_ticks(const char *line)
{
    uint64_t began = ticks();
    line_read(line);
    return ticks() - began;
}

/* --- measuring -------------------------------------------------------------------------------- */

/* The processor reads lines by two: even ones are measured in one step, odd ones in the next.  The
 * last two of a page are not: one of them is read before each other one, which then pays for no
 * translation of the page's address. */
enum { LINES = PAGE_BYTES / LINE_BYTES - 2 };

static void lines_flush(const struct heap *h)
{
    for (uint32_t page = 0; page < h->numbers; page++) {
        for (size_t at = 0; h->known[page] && at < PAGE_BYTES; at += LINE_BYTES) {
            line_flush(h->known[page] + at);
        }
    }
}

static uint64_t near_ticks(void)
{
    char near = 0;
    uint64_t least = UINT64_MAX;
    for (int i = 0; i < 16; i++) {
        uint64_t took = line_ticks(&near);
        least = took < least ? took : least;
    }
    return least + NEAR_TICKS;
}

/* Pages come in no order that the processor could read ahead in. */
static void lines_measure(struct prefetch *p, const struct heap *h)
{
    _Static_assert((HEAP_KNOWN & (HEAP_KNOWN - 1)) == 0, "each page comes once");
    uint64_t near = near_ticks();
    for (uint32_t line = p->first; line < LINES; line += 2) {
        for (uint32_t i = 0; i < HEAP_KNOWN; i++) {
            uint32_t page = i * (i + 1) / 2 % HEAP_KNOWN;
            const char *at = h->known[page];
            if (!at) {
                continue;
            }
            line_read(at + (LINES + 1 - p->first) * LINE_BYTES);
            if (line_ticks(at + line * LINE_BYTES) < near) {
                p->lines[page] |= 1ull << line;
            }
        }
    }
}

static bool measure_is_due(const struct prefetch *p)
{
    uint64_t each = p->measured > 0 ? MEASURE_AGAIN : MEASURE_FIRST;
    return p->first == 1 || p->steps - p->measured >= each * p->minds;
}

static void measure_begin(struct prefetch *p, const struct mind *m)
{
    if (p->first == 0) {
        memset(p->lines, 0, sizeof p->lines);
    }
    p->by = m;
    lines_flush(&m->heap);
}

static void measure_end(struct prefetch *p, const struct mind *m)
{
    lines_measure(p, &m->heap);
    p->by = NULL;
    p->measured = p->first == 1 ? p->steps : p->measured;
    p->first = 1 - p->first;
}

/* --- steps ------------------------------------------------------------------------------------ */

/* @return NULL: there are too many others */
static struct prefetch *prefetch_take(uint64_t shape)
{
    struct prefetch *unused = NULL;
    for (struct prefetch *p = prefetches; p < prefetches + SHAPES; p++) {
        if (p->minds > 0 && p->shape == shape) {
            p->minds++;
            return p;
        }
        unused = p->minds > 0 ? unused : p;
    }
    if (unused) {
        *unused = (struct prefetch){.shape = shape, .minds = 1};
    }
    return unused;
}

static uint32_t lines_ask(const struct prefetch *p, const struct heap *h)
{
    uint32_t asked = 0;
    for (uint32_t page = 0; page < h->numbers; page++) {
        for (uint64_t left = h->known[page] ? p->lines[page] : 0; left > 0; left &= left - 1) {
            __builtin_prefetch(h->known[page] + __builtin_ctzll(left) * LINE_BYTES, 1);
            asked++;
        }
    }
    return asked;
}

uint32_t prefetch_begin(struct mind *m)
{
    if (!m->stepped) { /* its heap is what its rules have made of it */
        m->stepped = true;
        m->prefetch = prefetch_take(m->heap.shape);
    }
    struct prefetch *p = m->prefetch;
    if (!p || pages_chunks() < CHUNKS_MIN) {
        return 0;
    }
    p->steps++;
    if (measure_is_due(p)) {
        measure_begin(p, m);
        return 0;
    }
    return lines_ask(p, &m->heap);
}

void prefetch_end(const struct mind *m)
{
    if (m->prefetch && m->prefetch->by == m) {
        measure_end(m->prefetch, m);
    }
}

void prefetch_forget(struct mind *m)
{
    if (m->prefetch) {
        m->prefetch->minds--;
        m->prefetch->by = m->prefetch->by == m ? NULL : m->prefetch->by;
    }
    m->prefetch = NULL;
    m->stepped = false;
}
