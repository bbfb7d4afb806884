/* SPDX-License-Identifier: Apache-2.0 */
#include "replay/channels.h"
#include "bus/raw/raw.h"

#include "core/text.h"
#include "mcap/mcap.h"
#include "muster/memory.h"
#include "muster/version.h"

#include <stdio.h>
#include <string.h>

enum { ORIGIN_BYTES = 128 };

/* What processes say to each other means something to them: it is replayed only on request. */
static const enum bus_topic for_observers[] = {
    BUS_SCENE,         BUS_FRAME,       BUS_RUN_STATUS,   BUS_PAGES,
    BUS_BROKER_STATUS, BUS_PART_STATUS, BUS_BROKER_EVENT,
};

/* --- what a channel says of itself ------------------------------------------------------------ */

/* @return the value of a key; NULL: there is none */
static const char *pair_of(const struct mcap_channel *c, const char *key)
{
    for (size_t i = 0; i < c->pairs_count; i++) {
        if (strcmp(c->pairs[i].key, key) == 0) {
            return c->pairs[i].value;
        }
    }
    return NULL;
}

/* @return the topic whose instances these are that have gone; NULL: it has samples */
static const char *gone_of(const struct mcap_channel *c)
{
    bool is = strcmp(c->schema_name, GONE_SCHEMA_NAME) == 0;
    return is ? pair_of(c, "gone_of") : NULL;
}

static bool is_partition(const char *key)
{
    return strcmp(key, "partition") == 0 || strncmp(key, "partition.", 10) == 0;
}

/* @return how many there are; where none is said it is the default one */
static size_t partitions_of(const struct mcap_channel *c,
                            const char *names[MU_RECORD_PARTITIONS_MAX])
{
    size_t count = 0;
    for (size_t i = 0; i < c->pairs_count && count < MU_RECORD_PARTITIONS_MAX; i++) {
        if (is_partition(c->pairs[i].key)) {
            names[count++] = c->pairs[i].value;
        }
    }
    names[0] = count > 0 ? names[0] : "";
    return count > 0 ? count : 1;
}

static bool is_same_pair(const struct mcap_channel *a, const struct mcap_channel *b,
                         const char *key)
{
    const char *one = pair_of(a, key), *other = pair_of(b, key);
    return one && other ? strcmp(one, other) == 0 : one == other;
}

/* @return whether a channel's instances are those of another one's samples */
static bool is_of(const struct mcap_channel *gone, const struct mcap_channel *samples)
{
    const char *a[MU_RECORD_PARTITIONS_MAX], *b[MU_RECORD_PARTITIONS_MAX];
    size_t count = partitions_of(gone, a);
    bool same = strcmp(gone_of(gone), samples->topic) == 0 && partitions_of(samples, b) == count &&
                is_same_pair(gone, samples, "dds_type") && is_same_pair(gone, samples, "dds_qos");
    for (size_t i = 0; i < count && same; i++) {
        same = strcmp(a[i], b[i]) == 0;
    }
    return same;
}

/* --- which are wanted ------------------------------------------------------------------------- */

static bool is_named(const struct channels *c, const char *topic)
{
    for (size_t i = 0; i < c->topics->count; i++) {
        const char *name = c->topics->items[i];
        if (strcmp(name, topic) == 0 || strcmp(name, "all") == 0) {
            return true;
        }
    }
    return false;
}

static bool is_for_observers(enum bus_topic topic)
{
    for (size_t i = 0; i < sizeof for_observers / sizeof for_observers[0]; i++) {
        if (for_observers[i] == topic) {
            return true;
        }
    }
    return false;
}

/* @return whether the messages of a channel are what the topic has today */
static bool is_same_type(const struct mcap_channel *c, enum bus_topic topic)
{
    return strcmp(c->encoding, "cdr") == 0 && c->schema_size > 0 &&
           bus_schema_is(topic, c->schema, c->schema_size);
}

/* --- ours ------------------------------------------------------------------------------------- */

static void older_say(const struct channels *c, const char *topic)
{
    char bytes[ORIGIN_BYTES];
    struct mu_text origin = mu_text_in(bytes, sizeof bytes);
    mcap_origin_write(c->file, &origin);
    fprintf(stderr,
            "muster replay: %s is left out: it was written by %s, whose %s is another type than "
            "that of this muster, %s: replay it with the one that wrote it\n",
            topic, origin.at, topic, MU_VERSION);
}

static struct feed *feed_add(struct channels *c, uint32_t index)
{
    c->feeds[index] = mu_startup_alloc(sizeof *c->feeds[index]);
    return c->feeds[index];
}

static mu_result ours_open(struct channels *c, uint32_t index, enum bus_topic topic)
{
    const struct mcap_channel *channel = mcap_reader_channel(c->file, index);
    const char *names[MU_RECORD_PARTITIONS_MAX];
    size_t count = partitions_of(channel, names);
    if (c->topics->count > 0 ? !is_named(c, channel->topic) : !is_for_observers(topic)) {
        return MU_OK;
    }
    if (!is_same_type(channel, topic)) {
        older_say(c, channel->topic);
        return MU_OK;
    }
    if (topic == BUS_FRAME) { /* to readers of every one, and to readers of the latest */
        return feed_open(feed_add(c, index), c->bus, topic, "every", "latest");
    }
    return feed_open(feed_add(c, index), c->bus, topic, names[0], count > 1 ? names[1] : NULL);
}

/* --- others' ---------------------------------------------------------------------------------- */

/* Reads what describes a channel's type.  @return how many bytes; 0: there is nothing, or no room
 */
static size_t type_read(struct channels *c, const struct mcap_channel *channel, void *to,
                        size_t most)
{
    const char *name = pair_of(channel, "dds_type_file");
    uint32_t index = name ? mcap_reader_attachment_find(c->file, name) : MU_NONE;
    const struct mcap_attachment *a =
        index == MU_NONE ? NULL : mcap_reader_attachment(c->file, index);
    bool read = a && mcap_reader_attachment_read(c->file, index, to, most) == MU_OK;
    return read ? (size_t)a->size : 0;
}

static void foreign_say(const struct mcap_channel *channel, const char *why)
{
    char shown[MU_TEXT_SHOWN];
    fprintf(stderr, "muster replay: %s is left out: %s\n", mu_text_show(shown, channel->topic),
            why);
}

static void foreign_open(struct channels *c, uint32_t index)
{
    static unsigned char type[MU_RECORD_TYPE_MAX];
    const struct mcap_channel *channel = mcap_reader_channel(c->file, index);
    const char *names[MU_RECORD_PARTITIONS_MAX];
    const char *name = pair_of(channel, "dds_type"), *words = pair_of(channel, "dds_qos");
    size_t size = type_read(c, channel, type, sizeof type);
    if (c->topics->count > 0 && !is_named(c, channel->topic)) {
        return;
    }
    if (!name || size == 0) {
        foreign_say(channel, "the recording does not say what its type is on DDS");
        return;
    }
    struct feed_foreign of = {.topic = channel->topic,
                              .type = name,
                              .type_bytes = type,
                              .type_size = size,
                              .words = words ? words : "",
                              .partitions = names};
    of.partition_count = partitions_of(channel, names);
    struct feed *feed = feed_add(c, index);
    mu_result opened = feed_open_foreign(feed, c->bus, &of);
    if (opened != MU_OK) {
        c->feeds[index] = NULL;
        foreign_say(channel, opened == MU_MALFORMED
                                 ? "what the recording says of its type is damaged"
                                 : "DDS makes no such writer");
    }
}

/* --- all of them ------------------------------------------------------------------------------ */

static mu_result samples_open(struct channels *c, uint32_t index)
{
    const struct mcap_channel *channel = mcap_reader_channel(c->file, index);
    enum bus_topic topic;
    if (feed_topic(channel->topic, pair_of(channel, "dds_type"), &topic)) {
        return ours_open(c, index, topic);
    }
    foreign_open(c, index);
    return MU_OK;
}

/* What has gone goes where the samples went. */
static void gone_open(struct channels *c, uint32_t index)
{
    const struct mcap_channel *gone = mcap_reader_channel(c->file, index);
    for (uint32_t i = 0; i < mcap_reader_channels(c->file) && !c->feeds[index]; i++) {
        if (c->feeds[i] && !c->gone[i] && is_of(gone, mcap_reader_channel(c->file, i))) {
            c->feeds[index] = c->feeds[i];
            c->gone[index] = true;
        }
    }
}

mu_result channels_open(struct channels *c)
{
    uint32_t count = mcap_reader_channels(c->file);
    for (uint32_t i = 0; i < count; i++) {
        if (!gone_of(mcap_reader_channel(c->file, i))) {
            MU_TRY(samples_open(c, i));
            c->count += c->feeds[i] != NULL;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        if (gone_of(mcap_reader_channel(c->file, i))) {
            gone_open(c, i);
        }
        mcap_reader_pick(c->file, i, c->feeds[i] != NULL);
    }
    return MU_OK;
}

mu_result channels_write(struct channels *c, const struct mcap_message *m)
{
    struct feed *feed = c->feeds[m->channel];
    const void *key;
    size_t size;
    if (!c->gone[m->channel]) {
        return feed_write(feed, m->data, m->size);
    }
    enum gone_what what = gone_read(m->data, m->size, &key, &size);
    return what == GONE_NOT ? MU_MALFORMED : feed_gone(feed, what, key, size);
}
