/* SPDX-License-Identifier: Apache-2.0 */
#include "core/sensors.h"

#include <string.h>

static const char *const words[] = {
#define X(id, word, ...) word,
    MU_SENSORS(X)
#undef X
};

uint32_t mu_sensor_bits(const char *word)
{
    for (uint32_t i = 0; i < MU_SENSOR_COUNT; i++) {
        if (strcmp(word, words[i]) == 0) {
            return 1u << i;
        }
    }
    return strcmp(word, "all") == 0 ? MU_SENSES : 0;
}

void mu_sensor_add(struct mu_text *out, uint32_t senses)
{
    const char *between = "";
    for (uint32_t i = 0; i < MU_SENSOR_COUNT; i++) {
        if (senses & 1u << i) {
            mu_text_format(out, "%s%s", between, words[i]);
            between = ", ";
        }
    }
}

const struct mu_field mu_readings[MU_READING_COUNT] = {
#define X(type, member, unit, ...) \
    {MU_FIELD_##type, MU_UNIT_##unit, offsetof(struct mu_percept, member)},
    MU_READINGS(X)
#undef X
};

/* The fields of an element, by the column "unit in rules". */
#define PLAIN(unit) {MU_FIELD_float, MU_UNIT_##unit, 0},
#define BLOB(type, member, unit, ...) \
    {MU_FIELD_##type, MU_UNIT_##unit, offsetof(struct mu_blob, member)},
#define FIDUCIAL(type, member, unit, ...) \
    {MU_FIELD_##type, MU_UNIT_##unit, offsetof(struct mu_fiducial, member)},
#define FIELDS_MM       PLAIN(MM)
#define FIELDS_AS_IS    PLAIN(AS_IS)
#define FIELDS_BLOB     MU_BLOB(BLOB)
#define FIELDS_FIDUCIAL MU_FIDUCIAL(FIDUCIAL)

const struct mu_channel mu_channels[MU_CHANNEL_COUNT] = {
#define X(id, all, type, member, counted, limit, unit, word, said) \
    {.fact = word, \
     .text = said, \
     .senses = all, \
     .list = offsetof(struct mu_percept, member), \
     .count = offsetof(struct mu_percept, counted), \
     .most = limit, \
     .bytes = sizeof(type), \
     .plain = _Generic((type *)0, float *: true, default: false), \
     .fields = (const struct mu_field[]){FIELDS_##unit}, \
     .field_count = sizeof((const struct mu_field[]){FIELDS_##unit}) / sizeof(struct mu_field)},
    MU_CHANNELS(X)
#undef X
};

const void *mu_channel_list(const struct mu_channel *c, const struct mu_percept *p, size_t *count)
{
    const void *list;
    memcpy(&list, (const char *)p + c->list, sizeof list);
    memcpy(count, (const char *)p + c->count, sizeof *count);
    return list;
}

void mu_channel_set(const struct mu_channel *c, struct mu_percept *p, const void *list,
                    size_t count)
{
    memcpy((char *)p + c->list, &list, sizeof list);
    memcpy((char *)p + c->count, &count, sizeof count);
}
