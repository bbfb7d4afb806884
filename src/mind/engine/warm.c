/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A step of one of many minds waits for memory most of the time: it needs some 500 lines of the
 * cache, from which the other minds have driven them meanwhile.  They are nearly the same ones in
 * every step, and in minds of the same rules they stand in the same places of their heaps; so they
 * are asked for at once when a step begins.  Which ones they are, the cache itself tells: all lines
 * of one mind are flushed, it makes its step, and what is quick to read then was used.
 *
 * Nothing depends on it but time.
 */
#include "mind/engine/engine.h"

#include <string.h>

enum {
    LINE_BYTES = 64,
    WARM_SHAPES = 16,  /* different rules in a process; minds with others are as they were */
    WARM_FIRST = 16,   /* the step of a mind in which it measures even lines, before the odd ones */
    WARM_PERIOD = 1024 /* steps from one measurement to the next */
};

/* What minds whose heaps have grown alike use in a step. */
struct warm {
    uint64_t shape;             /* 0: free */
    const struct mind *by;      /* the one that measures; NULL: the next one will */
    uint32_t step;              /* of that mind */
    uint64_t lines[HEAP_KNOWN]; /* of each page, a bit for each line */
};

static struct warm warms[WARM_SHAPES];

/* --- lines ------------------------------------------------------------------------------------ */

#ifdef __SSE2__
#include <x86intrin.h>

enum { WARM_CHUNKS = 16 }; /* the cache has what fewer minds would ask for */

static void line_flush(const char *line)
{
    _mm_clflush(line);
}

static uint64_t line_ticks(const volatile char *line)
{
    unsigned processor;
    _mm_lfence();
    uint64_t began = __rdtscp(&processor);
    _mm_lfence();
    (void)*line;
    uint64_t ended = __rdtscp(&processor);
    _mm_lfence();
    return ended - began;
}
#else /* no program can flush a line, or no clock is fast enough */
enum { WARM_CHUNKS = INT32_MAX };

static void line_flush(const char *line)
{
    (void)line;
}

static uint64_t line_ticks(const volatile char *line)
{
    return (uint64_t)*line;
}
#endif

/* --- measuring -------------------------------------------------------------------------------- */

/* The processor reads lines by two: even ones are measured in one step, odd ones in the next.  The
 * last two of a page are not: one of them is read before each other one, which then pays for no
 * translation of the page's address. */
enum { LINES = PAGE_BYTES / LINE_BYTES - 2 };

/* @return the first of the lines that are measured in this step; -1: none are */
static int32_t measured(const struct warm *w)
{
    uint32_t step = w->step % WARM_PERIOD;
    return step == WARM_FIRST || step == WARM_FIRST + 1 ? (int32_t)(step - WARM_FIRST) : -1;
}

static void lines_flush(const struct heap *h)
{
    for (uint32_t page = 0; page < h->opened; page++) {
        for (size_t at = 0; h->known[page] && at < PAGE_BYTES; at += LINE_BYTES) {
            line_flush(h->known[page] + at);
        }
    }
}

/* @return more ticks than a line of the first two caches takes, and less than of the third */
static uint64_t near_ticks(void)
{
    char near = 0;
    uint64_t least = UINT64_MAX;
    for (int i = 0; i < 16; i++) {
        uint64_t ticks = line_ticks(&near);
        least = ticks < least ? ticks : least;
    }
    return least + 50;
}

/* In no order of pages that the processor could read ahead in. */
static void lines_measure(struct warm *w, const struct heap *h, uint32_t first)
{
    uint64_t near = near_ticks();
    for (uint32_t line = first; line < LINES; line += 2) {
        for (uint32_t i = 0; i < HEAP_KNOWN; i++) {
            uint32_t page = i * (i + 1) / 2 % HEAP_KNOWN; /* each once */
            const char *at = h->known[page];
            if (at && line_ticks(at + (LINES + 1 - first) * LINE_BYTES) > 0 &&
                line_ticks(at + line * LINE_BYTES) < near) {
                w->lines[page] |= 1ull << line;
            }
        }
    }
}

/* --- steps ------------------------------------------------------------------------------------ */

/* @return NULL: there are too many others */
static struct warm *warm_of(const struct mind *m)
{
    for (struct warm *w = warms; w < warms + WARM_SHAPES; w++) {
        w->shape = w->shape ? w->shape : m->shape;
        if (w->shape == m->shape) {
            return w;
        }
    }
    return NULL;
}

void warm_begin(struct mind *m)
{
    if (pages_chunks() < WARM_CHUNKS) {
        return;
    }
    m->shape = m->shape ? m->shape : m->heap.shape | 1;
    struct warm *w = warm_of(m);
    if (!w) {
        return;
    }
    w->by = w->by ? w->by : m;
    if (w->by == m && measured(w) >= 0) {
        if (measured(w) == 0) {
            memset(w->lines, 0, sizeof w->lines);
        }
        lines_flush(&m->heap);
        return;
    }
    for (uint32_t page = 0; page < m->heap.opened; page++) {
        for (uint64_t left = w->lines[page]; left > 0; left &= left - 1) {
            __builtin_prefetch(m->heap.known[page] + __builtin_ctzll(left) * LINE_BYTES, 1);
        }
    }
}

void warm_end(struct mind *m)
{
    struct warm *w = m->shape ? warm_of(m) : NULL;
    if (w && w->by == m) {
        if (measured(w) >= 0) {
            lines_measure(w, &m->heap, (uint32_t)measured(w));
        }
        w->step++;
    }
}

void warm_forget(const struct mind *m)
{
    for (struct warm *w = warms; w < warms + WARM_SHAPES; w++) {
        if (w->by == m) {
            w->by = NULL;
            w->step = 0;
        }
    }
}
