/* SPDX-License-Identifier: Apache-2.0 */
#include "record/tape.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/table.h"
#include "core/text.h"
#include "muster/memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { SCHEMA_BYTES = 256 * 1024, PROFILE_BYTES = 1024 };

struct tape *tape_create(void)
{
    struct tape *t = mu_startup_alloc(sizeof *t);
    t->file = mcap_writer_create();
    return t;
}

mu_result tape_open(struct tape *t, const char *path, int domain)
{
    char number[16];
    char time[32];
    snprintf(number, sizeof number, "%d", domain);
    snprintf(time, sizeof time, "%" PRIu64, mu_clock_wall_ns());
    const struct mcap_pair about[] = {{"muster", MU_VERSION},
                                      {"domain", number},
                                      {"began_wall_ns", time},
                                      {"log_time", "source timestamp, nanoseconds since 1970"}};
    MU_TRY(mcap_writer_open(t->file, path, "muster " MU_VERSION));
    (void)mcap_writer_metadata(t->file, "recording", about, sizeof about / sizeof about[0]);
    return MU_OK;
}

/* Version 2 of CDR puts long numbers elsewhere, and lengths between them: no tool that goes by the
 * definitions knows that. */
static bool is_plain(const struct tap_sample *s)
{
    const unsigned char *bytes = s->data;
    return s->size >= 4 && bytes[0] == 0 && bytes[1] <= 1;
}

/* Adds a channel of a tap.  @return its index, or MU_NONE: there is no room */
static uint32_t channel_add(struct tape *t, struct tap *tap, const char *partition, bool plain)
{
    static char schema_bytes[SCHEMA_BYTES];
    char name_bytes[2 * TAP_NAME_MAX], profile_bytes[PROFILE_BYTES];
    struct mu_text name, schema, profile;
    uint32_t index = MU_NONE;
    mu_text_init(&name, name_bytes, sizeof name_bytes);
    mu_text_init(&schema, schema_bytes, sizeof schema_bytes);
    mu_text_init(&profile, profile_bytes, sizeof profile_bytes);
    bool said = plain && tap_schema(tap, &name, &schema) == MU_OK;
    tap_profile(tap, &profile);
    const struct mcap_pair pairs[] = {
        {"offered_qos_profiles", profile.at}, {"dds_type", tap->type}, {"partition", partition}};
    struct mcap_channel c = {.topic = tap->name,
                             .encoding = "cdr",
                             .schema_name = said ? name.at : "",
                             .schema_encoding = "ros2msg",
                             .schema = schema.at,
                             .schema_size = schema.len,
                             .pairs = pairs,
                             .pairs_count = sizeof pairs / sizeof pairs[0]};
    if (mcap_writer_channel(t->file, &c, &index) != MU_OK) {
        return MU_NONE;
    }
    t->channels[index] = (struct tape_channel){.tap = tap, .plain = plain};
    (void)mu_text_copy(t->channels[index].partition, TAP_NAME_MAX + 1, partition);
    t->channel_count = index + 1;
    mu_log(MU_LOG_INFO, "channel", "topic=%s partition=%s schema=%s", tap->name, partition,
           said ? name.at : "none");
    return index;
}

static uint32_t channel_find(struct tape *t, struct tap *tap, const char *partition, bool plain)
{
    for (uint32_t i = 0; i < t->channel_count; i++) {
        const struct tape_channel *c = &t->channels[i];
        if (c->tap == tap && c->plain == plain && strcmp(c->partition, partition) == 0) {
            return i;
        }
    }
    return channel_add(t, tap, partition, plain);
}

/* A writer does not change its encoding. */
static uint32_t channel_of(struct tape *t, struct tap *tap, const struct tap_sample *sample)
{
    uint64_t writer = sample->writer;
    size_t slot = (size_t)((writer * 0x9e3779b97f4a7c15u) >> 52) % TAPE_WRITERS;
    if (t->writers[slot].tap == tap && t->writers[slot].writer == writer) {
        return t->writers[slot].channel;
    }
    char partition[TAP_NAME_MAX + 1];
    bool there = tap_partition(tap, writer, partition, sizeof partition);
    uint32_t channel = channel_find(t, tap, partition, is_plain(sample));
    if (there && channel != MU_NONE) {
        t->writers[slot].writer = writer;
        t->writers[slot].tap = tap;
        t->writers[slot].channel = channel;
    }
    return channel;
}

void tape_take(void *self, struct tap *tap, const struct tap_sample *sample)
{
    struct tape *t = self;
    uint32_t channel = channel_of(t, tap, sample);
    if (channel == MU_NONE) {
        t->lost++;
        return;
    }
    struct mcap_message m = {.channel = channel,
                             .sequence = ++t->channels[channel].sequence,
                             .log_ns = sample->source_ns,
                             .publish_ns = sample->source_ns,
                             .data = sample->data,
                             .size = sample->size};
    mu_result taken = mcap_writer_message(t->file, &m);
    t->messages += taken == MU_OK;
    t->lost += taken != MU_OK;
}

bool tape_look(struct tape *t)
{
    mcap_writer_look(t->file, mu_clock_ns());
    return !mcap_writer_failed(t->file);
}

mu_result tape_close(struct tape *t)
{
    return mcap_writer_close(t->file);
}
