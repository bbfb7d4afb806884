/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file counters.h
 * The parts of the broker and what each counts: one table for the answer to `state`, for the topic
 * PartStatus and for docs/reference/counters.md.
 */
#ifndef MUSTER_BROKER_COUNTERS_H
#define MUSTER_BROKER_COUNTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct broker;

/* The broker's parts, by their index in the white pages; 0 there is the broker itself. */
enum counters_part {
    PART_REGISTRAR = 1,
    PART_POSTMASTER,
    PART_COURIER,
    PART_GROUPS,
    PART_SERVICES,
    PART_TRUST,
    PART_JOURNAL,
    PART_LIAISON,
    PARTS_END /* one more than the last */
};

/* Counters of all parts together. */
enum { COUNTERS_MAX = 128 };

struct counter {
    enum counters_part part;
    const char *name;   /* a CLIPS symbol */
    const char *counts; /* what, and in which unit, for people */
    bool drifts;        /* changes with time alone: no news in itself */
    size_t offset;      /* of the number in struct broker */
    size_t size;        /* of it: 4 or 8; 0: asked for by read */
    uint64_t (*read)(const struct broker *b);
};

/** @return the word for a part, without "broker." */
const char *counters_part_name(uint32_t part);

/** @return the index-th counter; the table is in order of part; NULL past the last */
const struct counter *counters_at(size_t index);

uint64_t counters_value(const struct broker *b, const struct counter *c);

/** Prints the table as Markdown to standard output. */
void counters_print(void);

#endif
