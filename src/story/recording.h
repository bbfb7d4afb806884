/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file recording.h
 * A recorded run: its scene, any of its steps, and what went on in its minds.
 *
 * A recording is read through once when it is opened; then any step can be asked for.  Memory is
 * taken when it is created; samples are DDS's.  One thread.
 */
#ifndef MUSTER_STORY_RECORDING_H
#define MUSTER_STORY_RECORDING_H

#include "mcap/mcap_read.h"
#include "story/interventions.h"
#include "story/minds.h"
#include "wire.h"

/* Where a step is found. */
struct recording_step {
    int64_t step;
    uint64_t log_ns;
};

/* How a recorded run ended. */
enum recording_end {
    RECORDING_DONE,    /* with its last step */
    RECORDING_STOPPED, /* before: somebody ended it.  The last Frame is how the world was left */
    RECORDING_FAULT,   /* before: somebody was silent, say.  The last Frame is a step like others */
    RECORDING_CUT      /* nobody knows.  The last Frame is one or the other */
};

struct recording {
    struct mcap_reader *reader;
    uint32_t frames;     /* channel of them */
    muster_Scene *scene; /* NULL: there is none */
    struct minds *minds;
    struct interventions *interventions;
    uint64_t step_ns;             /* simulated time of a step */
    struct recording_step *steps; /* in their order */
    size_t steps_count, steps_max;
    uint64_t malformed;  /* messages that are no Frame */
    muster_Frame *frame; /* of the last call, */
    uint64_t frame_ns;   /* and its log time */
    void *room;          /* for one message */
};

/** Takes the memory for a recording.  @return MU_OK; MU_FAULT_FILE: there is no such file */
MU_MUST_USE mu_result recording_create(struct recording *r, const char *path,
                                       struct mu_fault *fault);

/**
 * Opens it, or another one that is no longer, and reads it through; what was open is closed.
 *
 * @return MU_OK; MU_FAULT_FILE: not a recording of a run, or of another version's types
 */
MU_MUST_USE mu_result recording_open(struct recording *r, const char *path, struct mu_fault *fault);

/** @return a step's Frame, good until the next call; NULL: the recording does not have it */
const muster_Frame *recording_frame(struct recording *r, int64_t step);

/** @return what the run's table says of it under a key (docs/recording.md); "": nothing */
const char *recording_note(const struct recording *r, const char *key);

/** Gives the values that its command line set, KEY=VALUE, in their order; they live until the next
 * open.  @return how many there are, most at most */
size_t recording_sets(const struct recording *r, const char *sets[], size_t most);

/** @return how the recorded run ended; RECORDING_CUT when it has no step */
enum recording_end recording_end(const struct recording *r);

/** Goes to a step, or to the last one before it: recording_next gives it, and then the next. */
void recording_seek(struct recording *r, int64_t step);

/** Goes to the first Frame. */
void recording_rewind(struct recording *r);

/** @return the next Frame in order, good until the next call; NULL past the last */
const muster_Frame *recording_next(struct recording *r);

/** @return the last step that the recording has up to a simulated time; else its first one */
int64_t recording_step_at(const struct recording *r, double time_s);

void recording_close(struct recording *r);

#endif
