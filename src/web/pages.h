/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pages.h
 * The white pages, as brokers publish them for whoever looks: who has no agent is told no others.
 * Pure.
 */
#ifndef MUSTER_WEB_PAGES_H
#define MUSTER_WEB_PAGES_H

#include "core/json.h"
#include "core/table.h"
#include "muster/limits.h"
#include "wire.h"

enum { PAGES_LINES_MAX = 2048, PAGES_WORD_MAX = 15 };

struct pages_line {
    char name[MU_NAME_MAX + 1]; /* "": free */
    char kind[PAGES_WORD_MAX + 1], state[PAGES_WORD_MAX + 1];
    char host[MU_FIELD_MAX + 1];
    char reason[MU_FIELD_MAX + 1]; /* why it is in that state; "": it did not say */
    char broker[MU_NAME_MAX + 1];  /* who said it last, */
    uint32_t part;                 /* in this part of its pages */
    uint64_t turn;                 /* when */
};

struct pages {
    struct pages_line lines[PAGES_LINES_MAX];
    uint32_t count;        /* places that were ever taken */
    struct mu_table names; /* to places */
    uint64_t turn;
    uint64_t refused; /* lines that found no place, or were none */
};

/** Takes the memory, at start-up. */
void pages_init(struct pages *p);

/** Takes one part: it takes the place of what its broker said in it before. */
void pages_take(struct pages *p, const muster_Page *page);

/**
 * Writes them as one object: a list of [name, kind, state, host, reason], in the order in which
 * they came; without those who only look.
 */
void pages_write(struct mu_json *j, const struct pages *p);

#endif
