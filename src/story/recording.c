/* SPDX-License-Identifier: Apache-2.0 */
#include "story/story.h"

#include "bus/bus.h"
#include "bus/raw/raw.h"
#include "mcap/mcap.h"
#include "muster/limits.h"
#include "muster/memory.h"
#include "muster/version.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* No Frame is shorter. */
enum { RECORDING_FRAME_BYTES = 64 };

mu_result recording_create(struct recording *r, const char *path, struct mu_fault *fault)
{
    struct stat file;
    if (stat(path, &file) != 0) {
        return mu_fault_at(fault, path, 0, 0, "%s", strerror(errno));
    }
    *r = (struct recording){.reader = mcap_reader_create()};
    r->steps_max = (size_t)file.st_size / RECORDING_FRAME_BYTES + 1;
    r->steps = mu_startup_array(r->steps_max, sizeof *r->steps);
    r->interventions = mu_startup_alloc(sizeof *r->interventions);
    r->minds = minds_open((size_t)file.st_size, MU_ROBOTS_MAX);
    r->room = mu_startup_alloc(MU_RECORD_MESSAGE_MAX);
    return MU_OK;
}

/* The next message of a topic that is picked, as a sample; NULL: there is none any more. */
static void *sample_next(struct recording *r, enum bus_topic topic, uint64_t *log_ns)
{
    struct mcap_message message;
    void *sample;
    while (mcap_reader_next(r->reader, &message) == MU_OK) {
        if (message.size <= MU_RECORD_MESSAGE_MAX) {
            memcpy(r->room, message.data, message.size);
            *log_ns = message.log_ns;
            if (bus_decode(topic, r->room, message.size, &sample) == MU_OK) {
                return sample;
            }
        }
        r->malformed++;
    }
    return NULL;
}

/* Leaves out all channels but one. */
static void channel_pick(struct recording *r, uint32_t channel)
{
    for (uint32_t i = 0; i < mcap_reader_channels(r->reader); i++) {
        mcap_reader_pick(r->reader, i, i == channel);
    }
    mcap_reader_seek(r->reader, 0, UINT64_MAX);
}

static void frame_drop(struct recording *r)
{
    bus_decode_free(BUS_FRAME, r->frame);
    r->frame = NULL;
}

static void scene_read(struct recording *r)
{
    uint32_t channel = mcap_reader_find(r->reader, "Scene");
    if (channel != MU_NONE) {
        uint64_t log_ns;
        channel_pick(r, channel);
        r->scene = sample_next(r, BUS_SCENE, &log_ns);
    }
    r->step_ns = r->scene && r->scene->step_ns > 0 ? r->scene->step_ns : MU_STEP_NS;
}

/* A Frame that came in two ways is taken once. */
static void frame_enter(struct recording *r, const muster_Frame *f)
{
    bool later = r->steps_count == 0 || f->step > r->steps[r->steps_count - 1].step;
    if (!later || r->steps_count == r->steps_max) {
        return;
    }
    r->steps[r->steps_count++] = (struct recording_step){f->step, r->frame_ns};
    for (uint32_t i = 0; i < f->acts._length; i++) {
        minds_add(r->minds, f->acts._buffer[i].agent, (uint32_t)f->step, f->acts._buffer[i].diary);
    }
    for (uint32_t i = 0; i < f->orders._length; i++) {
        interventions_add(r->interventions, (uint32_t)f->step, &f->orders._buffer[i]);
    }
}

static void frames_read(struct recording *r)
{
    recording_rewind(r);
    for (const muster_Frame *f = recording_next(r); f; f = recording_next(r)) {
        frame_enter(r, f);
    }
}

/* What another version wrote is no sample of this one, or is one by accident. */
static mu_result types_check(struct recording *r, const char *path, struct mu_fault *fault)
{
    static const enum bus_topic needed[] = {BUS_FRAME, BUS_SCENE};
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        uint32_t channel = mcap_reader_find(r->reader, bus_topic_name(needed[i]));
        const struct mcap_channel *c =
            channel == MU_NONE ? NULL : mcap_reader_channel(r->reader, channel);
        if (c && !bus_schema_is(needed[i], c->schema, c->schema_size)) {
            char bytes[128];
            struct mu_text origin = mu_text_in(bytes, sizeof bytes);
            r->foreign = bus_topic_name(needed[i]);
            mcap_origin_write(r->reader, &origin);
            return mu_fault_at(fault, path, 0, 0,
                               "it was written by %s, whose %s is another type than that of this "
                               "muster, " MU_VERSION
                               ": use the one that wrote it, or do the run again with this one",
                               origin.at, r->foreign);
        }
    }
    return MU_OK;
}

mu_result recording_open(struct recording *r, const char *path, struct mu_fault *fault)
{
    recording_close(r);
    minds_clear(r->minds);
    r->interventions->count = 0;
    r->steps_count = 0;
    r->malformed = 0;
    r->foreign = NULL;
    MU_TRY(mcap_reader_open(r->reader, path, fault));
    MU_TRY(types_check(r, path, fault));
    r->frames = mcap_reader_find(r->reader, "Frame");
    if (r->frames == MU_NONE) {
        return mu_fault_at(fault, path, 0, 0,
                           mcap_reader_whole(r->reader)
                               ? "expected a recording of a run: it has no Frame"
                               : "it has no Frame: it is cut off before the first one, or is no "
                                 "recording of a run");
    }
    scene_read(r);
    frames_read(r);
    return MU_OK;
}

/* @return the index of the last step up to this one; 0 when all are later */
static size_t step_find(const struct recording *r, int64_t step)
{
    size_t from = 0, to = r->steps_count;
    while (to - from > 1) {
        size_t middle = from + (to - from) / 2;
        if (r->steps[middle].step <= step) {
            from = middle;
        } else {
            to = middle;
        }
    }
    return from;
}

const muster_Frame *recording_frame(struct recording *r, int64_t step)
{
    size_t index = step_find(r, step);
    if (r->steps_count == 0 || r->steps[index].step != step) {
        return NULL;
    }
    uint64_t log_ns = r->steps[index].log_ns;
    mcap_reader_seek(r->reader, log_ns, log_ns);
    const muster_Frame *f = recording_next(r);
    while (f && f->step != step) {
        f = recording_next(r);
    }
    return f;
}

const char *recording_note(const struct recording *r, const char *key)
{
    const char *value = mcap_reader_value(r->reader, "run", key);
    return value ? value : "";
}

size_t recording_sets(const struct recording *r, const char *sets[], size_t most)
{
    size_t count = 0;
    while (count < most) {
        char key[32];
        snprintf(key, sizeof key, "set.%zu", count + 1);
        sets[count] = recording_note(r, key);
        if (!sets[count][0]) {
            break;
        }
        count++;
    }
    return count;
}

/* @return how long the run was to be, ns; 0: it is not known */
static double wanted_ns(const struct recording *r)
{
    return round(strtod(recording_note(r, "duration_s"), NULL) * 1e9);
}

/* A run that is stopped says that it is done: how far it was to go tells. */
enum recording_end recording_end(const struct recording *r)
{
    if (r->steps_count == 0) {
        return RECORDING_CUT;
    }
    const struct recording_step *last = &r->steps[r->steps_count - 1];
    const char *state = mcap_reader_value(r->reader, "end", "state");
    const char *steps = mcap_reader_value(r->reader, "end", "steps");
    bool known = wanted_ns(r) > 0;
    bool over = known && (double)last->log_ns >= wanted_ns(r);
    if (!state) {
        return over ? RECORDING_DONE : RECORDING_CUT;
    }
    if (strcmp(state, "fault") == 0) {
        return RECORDING_FAULT;
    }
    bool stopped = known && !over && steps && strtoll(steps, NULL, 10) == last->step;
    return stopped ? RECORDING_STOPPED : RECORDING_DONE;
}

void recording_seek(struct recording *r, int64_t step)
{
    if (r->steps_count > 0) {
        mcap_reader_seek(r->reader, r->steps[step_find(r, step)].log_ns, UINT64_MAX);
    }
}

void recording_rewind(struct recording *r)
{
    channel_pick(r, r->frames);
}

/* Steps are counted from 0, and in 32 bits where there are many of them (minds.c). */
static bool step_fits(const muster_Frame *f)
{
    return f->step >= 0 && f->step < UINT32_MAX;
}

const muster_Frame *recording_next(struct recording *r)
{
    do {
        frame_drop(r);
        r->frame = sample_next(r, BUS_FRAME, &r->frame_ns);
        r->malformed += r->frame && !step_fits(r->frame);
    } while (r->frame && !step_fits(r->frame));
    return r->frame;
}

int64_t recording_step_at(const struct recording *r, double time_s)
{
    double step = floor(time_s * 1e9 / (double)r->step_ns + 0.5);
    int64_t whole = step < 0x1p62 ? (int64_t)step : INT64_MAX;
    return r->steps_count > 0 ? r->steps[step_find(r, whole)].step : 0;
}

void recording_close(struct recording *r)
{
    frame_drop(r);
    bus_decode_free(BUS_SCENE, r->scene);
    r->scene = NULL;
    mcap_reader_close(r->reader);
}
