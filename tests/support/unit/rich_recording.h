/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file rich_recording.h
 * A small recording of a run that has something of everything, in memory, to be wounded.
 */
#ifndef MUSTER_TESTS_RICH_RECORDING_H
#define MUSTER_TESTS_RICH_RECORDING_H

#include "bus/bus.h"
#include "bus/raw/raw.h"
#include "mcap/mcap.h"
#include "muster/version.h"
#include "rich.h"
#include "wound.h"

#include <stdlib.h>
#include <unistd.h>

enum { RICH_MAX = 1 << 16, RICH_STEPS = 12 };

struct rich_recording {
    char path[32]; /* where it lies, and then each wounded one */
    uint8_t bytes[RICH_MAX], wounded[RICH_MAX + WOUND_ROOM];
    size_t len;
};

/* Without its definition: the file is a third as long, and its wounds are in what is read. */
static inline bool rich_sample_add(struct mcap_writer *w, enum bus_topic topic, uint32_t *channel,
                                   const void *sample, uint64_t log_ns)
{
    static struct bus_bytes bytes;
    struct mcap_channel c = {
        .topic = bus_topic_name(topic), .encoding = "cdr", .schema_name = "", .schema = ""};
    if (*channel == UINT32_MAX && mcap_writer_channel(w, &c, channel) != MU_OK) {
        return false;
    }
    if (bus_encode(topic, sample, &bytes) != MU_OK) {
        return false;
    }
    struct mcap_message m = {
        .channel = *channel, .log_ns = log_ns, .data = bytes.data, .size = bytes.size};
    return mcap_writer_message(w, &m) == MU_OK;
}

/* Whoever has the file open keeps what it was. */
static inline bool rich_put(const struct rich_recording *r, const uint8_t *bytes, size_t len)
{
    unlink(r->path);
    FILE *file = fopen(r->path, "w");
    bool put = file && fwrite(bytes, 1, len, file) == len;
    return file && fclose(file) == 0 && put;
}

static inline bool rich_steps_add(struct mcap_writer *w)
{
    muster_Scene scene = rich_scene();
    uint32_t scenes = UINT32_MAX, frames = UINT32_MAX;
    bool good = rich_sample_add(w, BUS_SCENE, &scenes, &scene, 0);
    for (int64_t step = 0; step < RICH_STEPS && good; step++) {
        muster_Frame f = rich_frame(step);
        good = rich_sample_add(w, BUS_FRAME, &frames, &f, f.time_ns);
        if (step == RICH_STEPS / 2) {
            mcap_writer_look(w, UINT64_MAX / 2); /* another chunk */
        }
    }
    return good;
}

/** Makes it, in a file of its own below /tmp.  @return whether it is there */
static inline bool rich_recording_make(struct rich_recording *r)
{
    static const struct mcap_pair about[] = {{"seed", "7"}, {"muster", MU_VERSION}};
    struct mcap_writer *w = mcap_writer_create();
    snprintf(r->path, sizeof r->path, "/tmp/muster-rich-XXXXXX");
    int fd = mkstemp(r->path);
    if (fd < 0 || close(fd) != 0 || mcap_writer_open(w, r->path, "test") != MU_OK) {
        return false;
    }
    (void)mcap_writer_metadata(w, "run", about, 2);
    bool good = rich_steps_add(w);
    good = mcap_writer_close(w) == MU_OK && good;
    FILE *file = fopen(r->path, "r");
    r->len = file ? fread(r->bytes, 1, sizeof r->bytes, file) : 0;
    good = file && fclose(file) == 0 && good;
    return good && r->len > 0 && r->len < sizeof r->bytes;
}

/** Puts a wounded copy in its place.  @return whether it could */
static inline bool rich_recording_wound(struct rich_recording *r, struct mu_random *random)
{
    return rich_put(r, r->wounded, wound_file(random, r->wounded, r->bytes, r->len));
}

#endif
