/* SPDX-License-Identifier: Apache-2.0 */
#include "record/tape.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/table.h"
#include "core/text.h"
#include "muster/memory.h"
#include "muster/version.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum {
    SCHEMA_BYTES = 256 * 1024,
    PROFILE_BYTES = 1024,
    PAIRS_MAX = MU_RECORD_PARTITIONS_MAX + 5,
    PROBES = 8,
};

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

/* --- channels --------------------------------------------------------------------------------- */

/* Pairs of a channel, with room for partitions' keys and names. */
struct pairs {
    struct mcap_pair all[PAIRS_MAX];
    size_t count;
    char keys[MU_RECORD_PARTITIONS_MAX][16];
    char names[TAP_PARTITIONS_MAX + 1];
};

static void pair_add(struct pairs *p, const char *key, const char *value)
{
    MU_ASSERT(p->count < PAIRS_MAX);
    p->all[p->count++] = (struct mcap_pair){key, value};
}

/* "partition", and "partition.2" and so on where a writer has more of them. */
static void partitions_add(struct pairs *p, const char *partitions)
{
    mu_text_copy(p->names, sizeof p->names, partitions);
    char *name = p->names;
    for (size_t i = 0; i < MU_RECORD_PARTITIONS_MAX && name; i++) {
        char *end = strchr(name, '\n');
        if (end) {
            *end = '\0';
        }
        snprintf(p->keys[i], sizeof p->keys[i], i > 0 ? "partition.%zu" : "partition", i + 1);
        pair_add(p, p->keys[i], name);
        name = end ? end + 1 : NULL;
    }
    if (name) {
        mu_log(MU_LOG_WARNING, "partitions", "a writer has more than %d; the others are not said",
               MU_RECORD_PARTITIONS_MAX);
    }
}

/* Adds what the type is, as DDS programs tell it, once: a replay makes a topic of it. */
static void type_attach(struct tape *t, struct tape_channel *c, struct tap *tap)
{
    static uint8_t bytes[MU_RECORD_TYPE_MAX];
    for (uint32_t i = 0; i < t->channel_count; i++) {
        if (t->channels[i].tap == tap) {
            mu_text_copy(c->type, sizeof c->type, t->channels[i].type);
            return;
        }
    }
    struct mu_text name = mu_text_in(c->type, sizeof c->type);
    mu_text_add(&name, "types/");
    size_t size = tap_type(tap, bytes, sizeof bytes, &name);
    bool kept =
        size > 0 && !name.cut &&
        mcap_writer_attach(t->file, c->type, "application/octet-stream", bytes, size) == MU_OK;
    if (!kept) {
        c->type[0] = '\0';
    }
}

static void pairs_make(struct pairs *p, const struct tape_channel *c, const char *profile)
{
    p->count = 0;
    pair_add(p, "offered_qos_profiles", profile);
    pair_add(p, "dds_type", c->tap->type);
    partitions_add(p, c->offer.partitions);
    if (c->offer.words[0]) {
        pair_add(p, "dds_qos", c->offer.words);
    }
    if (c->type[0]) {
        pair_add(p, "dds_type_file", c->type);
    }
    if (c->gone) {
        pair_add(p, "gone_of", c->tap->name);
    }
}

/* Writes what the messages of a channel are.  @return false: nothing can be said */
static bool schema_make(const struct tape_channel *c, struct mu_text *name, struct mu_text *schema)
{
    if (c->gone) {
        mu_text_add(name, GONE_SCHEMA_NAME);
        mu_text_add(schema, GONE_SCHEMA);
        return true;
    }
    return c->plain && tap_schema(c->tap, name, schema) == MU_OK;
}

/* Adds a channel.  @return its index, or MU_NONE: there is no room */
static uint32_t channel_add(struct tape *t, const struct tape_channel *added)
{
    static char schema_bytes[SCHEMA_BYTES];
    static struct pairs pairs;
    char name_bytes[2 * TAP_NAME_MAX], profile_bytes[PROFILE_BYTES];
    char topic[TAP_NAME_MAX + sizeof GONE_SUFFIX];
    uint32_t index = MU_NONE;
    struct mu_text name = mu_text_in(name_bytes, sizeof name_bytes);
    struct mu_text schema = mu_text_in(schema_bytes, sizeof schema_bytes);
    struct mu_text profile = mu_text_in(profile_bytes, sizeof profile_bytes);
    bool said = schema_make(added, &name, &schema);
    tap_profile(added->tap, &added->offer, &profile);
    pairs_make(&pairs, added, profile.at);
    snprintf(topic, sizeof topic, "%s%s", added->tap->name, added->gone ? GONE_SUFFIX : "");
    struct mcap_channel c = {.topic = topic,
                             .encoding = "cdr",
                             .schema_name = said ? name.at : "",
                             .schema_encoding = "ros2msg",
                             .schema = schema.at,
                             .schema_size = schema.len,
                             .pairs = pairs.all,
                             .pairs_count = pairs.count};
    if (mcap_writer_channel(t->file, &c, &index) != MU_OK) {
        return MU_NONE;
    }
    t->channels[index] = *added;
    t->channel_count = index + 1;
    mu_log(MU_LOG_INFO, "channel", "topic=%s partition=%s schema=%s", topic, pairs.names,
           said ? name.at : "none");
    return index;
}

static bool is_same(const struct tape_channel *a, const struct tape_channel *b)
{
    return a->tap == b->tap && a->plain == b->plain && a->gone == b->gone &&
           strcmp(a->offer.partitions, b->offer.partitions) == 0 &&
           strcmp(a->offer.words, b->offer.words) == 0;
}

static uint32_t channel_find(struct tape *t, struct tap *tap, struct tape_channel *c)
{
    for (uint32_t i = 0; i < t->channel_count; i++) {
        if (is_same(&t->channels[i], c)) {
            return i;
        }
    }
    if (!tap->ours) {
        type_attach(t, c, tap);
    }
    return channel_add(t, c);
}

/* --- writers ---------------------------------------------------------------------------------- */

/* @return a writer's place; one that is not known yet has channels of MU_NONE */
static struct tape_writer *writer_find(struct tape *t, const struct tap *tap, uint64_t writer)
{
    size_t home = (size_t)((writer * 0x9e3779b97f4a7c15u) >> 52) % TAPE_WRITERS;
    struct tape_writer *w = &t->writers[home];
    for (size_t i = 0; i < PROBES; i++) {
        struct tape_writer *at = &t->writers[(home + i) % TAPE_WRITERS];
        if (at->tap == tap && at->writer == writer) {
            return at;
        }
        w = at->tap == NULL && w->tap != NULL ? at : w;
    }
    *w = (struct tape_writer){
        .writer = writer, .tap = tap, .channel = MU_NONE, .gone_channel = MU_NONE};
    return w;
}

/* What a writer that has gone before it was looked at offered is not known: it is taken for one
 * like the first of its topic. */
static void offer_guess(const struct tape *t, const struct tap *tap, struct tape_channel *c)
{
    for (uint32_t i = t->channel_count; i > 0; i--) {
        if (t->channels[i - 1].tap == tap) {
            c->offer = t->channels[i - 1].offer;
        }
    }
}

/* A writer does not change its encoding.  @return the channel's index, or MU_NONE */
static uint32_t channel_of(struct tape *t, struct tap *tap, const struct tap_sample *sample)
{
    static struct tape_channel c;
    struct tape_writer *w = writer_find(t, tap, sample->writer);
    bool gone = sample->gone != GONE_NOT;
    uint32_t *known = gone ? &w->gone_channel : &w->channel;
    if (*known != MU_NONE) {
        return *known;
    }
    uint32_t other = gone ? w->channel : w->gone_channel;
    c = (struct tape_channel){.tap = tap, .plain = gone || is_plain(sample), .gone = gone};
    bool there = other != MU_NONE;
    if (there) {
        c.offer = t->channels[other].offer;
    } else {
        there = tap_offer(tap, sample->writer, &c.offer);
    }
    if (!there) {
        offer_guess(t, tap, &c);
    }
    uint32_t channel = channel_find(t, tap, &c);
    *known = there ? channel : MU_NONE;
    return channel;
}

/* --- samples ---------------------------------------------------------------------------------- */

void tape_take(void *self, struct tap *tap, const struct tap_sample *sample)
{
    static uint8_t gone[GONE_HEAD_BYTES + MU_RECORD_KEY_MAX];
    struct tape *t = self;
    size_t most = sample->gone == GONE_NOT ? MU_RECORD_MESSAGE_MAX : MU_RECORD_KEY_MAX;
    /* A channel without a message would stand in the file with no time. */
    uint32_t channel = sample->size <= most ? channel_of(t, tap, sample) : MU_NONE;
    if (channel == MU_NONE) {
        t->lost++;
        return;
    }
    bool lives = sample->gone == GONE_NOT;
    struct mcap_message m = {.channel = channel,
                             .sequence = ++t->channels[channel].sequence,
                             .log_ns = sample->source_ns,
                             .publish_ns = sample->source_ns,
                             .data = lives ? sample->data : gone,
                             .size = sample->size};
    if (!lives) {
        m.size = gone_write(gone, sample->gone, sample->data, sample->size);
    }
    mu_result taken = mcap_writer_message(t->file, &m);
    t->messages += taken == MU_OK;
    t->lost += taken == MU_FULL; /* what the disk has lost is told by the file */
}

bool tape_look(struct tape *t)
{
    mcap_writer_look(t->file, mu_clock_ns());
    return !mcap_writer_failed(t->file);
}

static bool is_first(const struct tape *t, uint32_t channel)
{
    for (uint32_t i = 0; i < channel; i++) {
        if (!t->channels[i].gone && t->channels[i].tap == t->channels[channel].tap) {
            return false;
        }
    }
    return !t->channels[channel].gone;
}

size_t tape_topics(const struct tape *t)
{
    size_t count = 0;
    for (uint32_t i = 0; i < t->channel_count; i++) {
        count += is_first(t, i);
    }
    return count;
}

mu_result tape_close(struct tape *t)
{
    return mcap_writer_close(t->file);
}
