/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sensors.h
 * The table of muster/sensors.h for code that runs over its rows.
 */
#ifndef MUSTER_CORE_SENSORS_H
#define MUSTER_CORE_SENSORS_H

#include "core/text.h"
#include "muster/percept.h"

/* All words, with a comma before each; and as a text of their own, without the first comma. */
#define MU_SENSOR_WORD_(id, word, ...) ", " word
#define MU_SENSOR_COMMAS               MU_SENSORS(MU_SENSOR_WORD_)
#define MU_SENSOR_WORDS                (&MU_SENSOR_COMMAS[2])

/** @return the bits of a sensor's word, or of "all"; 0: there is no such sensor */
uint32_t mu_sensor_bits(const char *word);

/** Adds the words of these sensors, with a comma between them. */
void mu_sensor_add(struct mu_text *out, uint32_t senses);

/* Units in rules, as in muster/sensors.h. */
enum mu_unit { MU_UNIT_MM, MU_UNIT_DEG, MU_UNIT_HEADING, MU_UNIT_COLOR, MU_UNIT_AS_IS };

enum mu_field_type {
    MU_FIELD_double,
    MU_FIELD_float,
    MU_FIELD_uint32_t,
    MU_FIELD_int32_t,
    MU_FIELD_bool
};

/* A number: of a percept or a record, or the only one of an element that is no record. */
struct mu_field {
    enum mu_field_type type;
    enum mu_unit unit;
    size_t at; /* bytes from the element's beginning */
};

#define MU_READING_NUMBER_(type, member, ...) MU_READING_##member,
enum mu_reading { MU_READINGS(MU_READING_NUMBER_) MU_READING_COUNT };

/* Where struct mu_percept has the numbers that every body has. */
extern const struct mu_field mu_readings[MU_READING_COUNT];

struct mu_channel {
    const char *fact, *text;
    uint32_t senses;    /* that must all be asked for */
    size_t list, count; /* where struct mu_percept has them */
    size_t most, bytes; /* elements, and bytes of each */
    bool plain;         /* a list of floats is one fact; else each element is one */
    size_t field_count;
    const struct mu_field *fields;
};

extern const struct mu_channel mu_channels[MU_CHANNEL_COUNT];

/** @return the list, and through count how many elements it has */
const void *mu_channel_list(const struct mu_channel *c, const struct mu_percept *p, size_t *count);

/** Points the percept to a list. */
void mu_channel_set(const struct mu_channel *c, struct mu_percept *p, const void *list,
                    size_t count);

#endif
