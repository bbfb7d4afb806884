/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file record.h
 * What is kept of a run: its hash, tracks, recording, Scene, Frames, totals, snapshots and orders.
 */
#ifndef MUSTER_SIM_RECORD_H
#define MUSTER_SIM_RECORD_H

#include "bus/bus.h"
#include "core/options.h"
#include "muster/limits.h"
#include "muster/result.h"
#include "sim/engine/engine.h"
#include "wire.h"
#include "world/condition/condition.h"
#include "world/model/world.h"

#include <stddef.h>
#include <stdint.h>

/*
 * The hash of a run: SHA-256 over everything that happened, in one fixed order.
 *
 * What an agent did in a step becomes a digest of its own when its answer arrives; the digests are
 * folded in the order of the robots when the step is complete, so that no order of arrival shows.
 */

enum { RUN_HASH_BYTES = 32, RUN_HASH_TEXT = 65 };

struct run_hash; /* one in a process */

/** Starts a run's hash; takes memory at start-up. */
struct run_hash *run_hash_open(void);

/** Digests what an agent did: command, rules fired, mails sent. */
void run_hash_act(struct run_hash *h, const muster_Act *act, unsigned char digest[RUN_HASH_BYTES]);

/** Folds bytes into the run: the bits of body states, digests. */
void run_hash_fold(struct run_hash *h, const void *bytes, size_t count);

/** Folds a number in, the same on every machine. */
void run_hash_fold_number(struct run_hash *h, uint64_t number);

/** Folds in what somebody outside did to the world: which order, to whom, and its numbers. */
void run_hash_order(struct run_hash *h, const muster_RunCommand *order);

/** Digests the mails that came from outside the roster in one step. */
void run_hash_outside(struct run_hash *h, const muster_Mail *mails, uint32_t count,
                      unsigned char digest[RUN_HASH_BYTES]);

/** @return the first 64 bits of what the hash would be if the run ended here */
uint64_t run_hash_peek(struct run_hash *h);

/** Ends the run: 64 hexadecimal digits. */
void run_hash_end(struct run_hash *h, char text[RUN_HASH_TEXT]);

/*
 * What a robot has come to since the run began: how far it went, how often and how long it was
 * stalled.
 *
 * It is counted as the report counts it from run.csv, from the same rounded numbers, so that both
 * say the same.
 */

/* Zero before the first step. */
struct tally {
    double distance_m, stalled_s;
    uint32_t stalls; /* how often it began to be stalled */
    bool seen, stalled;
    double x_m, y_m, time_s; /* of the step before, as in run.csv */
};

/**
 * Takes in one more step.
 *
 * @param time_ns  simulated, of this step
 * @param step_ns  what a stall counts that is there in the very first step
 */
void tally_take(struct tally *t, uint64_t time_ns, uint64_t step_ns,
                const struct engine_sample *sample);

/*
 * What stands in a world, for observers: what every Frame is drawn on.
 */

/**
 * Makes the Scene of a world; takes memory at start-up.
 *
 * Poses are those at which the world lets everything start.  The caller sets simulator, seed and
 * step_ns, and which robots are controlled.
 *
 * @return the sample, which points into the world
 */
muster_Scene *scene_make(const struct world *world);

/*
 * Changes from outside: those of a step wait for its end, the others for a time or a condition.
 * They are carried out in the order of source and sequence, so that the order in which they arrive
 * within a step does not show.
 */

enum { ORDER_FILE_MAX = 1023 };

/* A command with strings of its own. */
struct order {
    muster_RunCommand command; /* its strings are those below; simulator is not set */
    char source[MU_PROCESS_MAX + 1], name[MU_FIELD_MAX + 1], file[ORDER_FILE_MAX + 1];
    char when[MU_CONDITION_MAX + 1];
};

/** Copies a command with its strings; to must stay where it is. */
void order_copy(struct order *to, const muster_RunCommand *command);

struct order_queue; /* one in a process */

/** Takes memory at start-up. */
struct order_queue *order_queue_open(const struct condition_names *names);

/**
 * Keeps a copy of a command that the border has let through.
 *
 * @param why  CONDITION_WHY_MAX bytes: filled when it is not kept
 * @return MU_OK; MU_MALFORMED: its condition is none; MU_FULL: MU_ORDERS_MAX are due, or
 *         MU_ORDERS_LATER_MAX wait
 */
MU_MUST_USE mu_result order_queue_put(struct order_queue *q, const muster_RunCommand *command,
                                      char *why);

/** Notes what an agent with a body did in this step, for conditions. */
void order_queue_note_act(struct order_queue *q, int robot, const muster_Act *act);

/** Looks at the end of a step, before anything is done to the world, which orders are due. */
void order_queue_look(struct order_queue *q, uint64_t time_ns, const struct condition_view *view);

/** @return the next order that is due, good until the next call; NULL: none is */
const muster_RunCommand *order_queue_take(struct order_queue *q);

/*
 * Conditions of a run, and the CSV file of the times at which they come true: a state when it
 * begins, and a mail or a rule in every step that has one.
 */

struct events; /* one in a process */

/** @return the number of a body: the robots, then the objects; -1: the world has none of that name
 */
int record_find_body(const struct world *world, const char *name);

/** @return what conditions may name in a world, which must live as long */
struct condition_names record_names(const struct world *world);

/** Notes for a condition what an agent with a body did in this step. */
void record_note_act(struct condition_watch *w, int robot, const muster_Act *act);

/**
 * Creates the file; takes memory at start-up.
 *
 * @param texts  conditions; they stay with the caller
 * @return MU_OK; MU_FAULT_USAGE: a text is no condition; MU_FAULT_OS: the file cannot be made; both
 *         said on standard error
 */
MU_MUST_USE mu_result events_open(struct events **out, const char *path,
                                  const struct mu_option_list *texts,
                                  const struct condition_names *names);

/** Notes what an agent with a body did in this step. */
void events_note_act(struct events *e, int robot, const muster_Act *act);

/** Looks at all conditions at the end of a step, before anything is done to the world. */
void events_look(struct events *e, uint64_t time_ns, const struct condition_view *view);

/** @return MU_OK, or MU_FAULT_OS when the file is not whole, said on standard error */
MU_MUST_USE mu_result events_close(struct events *e);

/*
 * Puts a Frame together: all of one step, as observers see it.
 *
 * No clock and no network.  What others own is copied as it comes, into memory that was taken at
 * start-up; what does not fit is left out and counted.
 */

struct frame_builder; /* one in a process */

/** Takes the memory for Frames of a world.  @param simulator  its name; stays with the caller */
struct frame_builder *frame_open(const struct world *world, const char *simulator);

/** Begins the Frame of a step: without percepts and orders.  Acts stay until frame_clear. */
void frame_begin(struct frame_builder *v, int64_t step, uint64_t time_ns);

/** Says where a robot is, how it moves, and what it has come to. */
void frame_take_body(struct frame_builder *v, size_t robot, const struct engine_sample *sample,
                     const struct tally *tally);

/** Says where an object is. */
void frame_take_object(struct frame_builder *v, size_t object, struct world_pose pose);

/** Adds what a robot was sent.  What the percept points to must stay until the Frame is used. */
void frame_add_percept(struct frame_builder *v, const muster_Percept *percept);

/** Adds what a robot did, or, numbered behind the robots, an agent without a body.  A Frame has
 * acts in that order, then as they came. */
void frame_add_act(struct frame_builder *v, size_t robot, const muster_Act *act);

/** Keeps mails from outside, until they are taken: step is that of the Frame that shows them. */
void frame_add_outside(struct frame_builder *v, int64_t step, const muster_Mail *mails,
                       uint32_t count);

/** Adds an order that was carried out. */
void frame_add_order(struct frame_builder *v, const muster_RunCommand *order);

/** @return the robot's line in the Frame: state, commands and counters are the caller's to set */
muster_RobotView *frame_robot(struct frame_builder *v, size_t robot);

/** @return the Frame, good until the next call of any of these; digest and wall_ns are the
 *          caller's to set */
muster_Frame *frame_finish(struct frame_builder *v);

/** Forgets the acts. */
void frame_clear(struct frame_builder *v);

/** @return how many acts and mails were left out since the beginning */
uint64_t frame_left_out(const struct frame_builder *v);

/*
 * Writes run.csv: a row for each robot and control step; and placements.csv beside it, a row for
 * each time that a robot was put somewhere, if one was.
 */

struct tracks; /* one in a process */

/** Creates the file and writes its head.  @return MU_OK or MU_FAULT_OS, said on standard error */
MU_MUST_USE mu_result tracks_open(struct tracks **out, const char *path);

/** Adds a row.  A full disk shows at the close. */
void tracks_add(struct tracks *r, uint64_t time_ns, const char *robot,
                const struct engine_sample *sample);

/** @return MU_OK, or MU_FAULT_OS when the file is not whole, said on standard error */
MU_MUST_USE mu_result tracks_close(struct tracks *r);

/*
 * Writes run.mcap: what was needed for the run, the Scene, the Frame of each step, how it ended.
 *
 * docs/recording.md says what is in it.  Messages are sorted by simulated time.  A step copies its
 * bytes into memory; once a second or a megabyte these go to the system, which writes them when it
 * likes.  A full disk ends the recording, not the run.
 */

struct mcap_file; /* one in a process */

struct mcap_file_options {
    const char *path;
    const struct world *world;           /* by hand its files are attached as "world/..." */
    const struct mu_option_list *files;  /* "NAME=PATH": attached as NAME */
    const struct mu_option_list *notes;  /* "KEY=VALUE": of the table "run" */
    const struct mu_option_list *places; /* of robots: noted by hand */
    bool without_percepts;
    const char *command; /* that began it; by hand; NULL: `muster run`, which tells the rest */
    bool free;
    uint64_t seed;
    double duration_s;
};

/**
 * Creates the file, with all that is known before the run.
 *
 * @return MU_OK; MU_FAULT_OS: it cannot be created, said on standard error.  A file that cannot be
 *         attached is said there, too, and is not in it.
 */
MU_MUST_USE mu_result mcap_file_open(struct mcap_file **out,
                                     const struct mcap_file_options *options);

/** Adds the Scene, before the first Frame. */
void mcap_file_scene(struct mcap_file *f, const muster_Scene *scene);

/** Adds a step. */
void mcap_file_frame(struct mcap_file *f, const muster_Frame *frame);

/** Says how the run has ended. */
void mcap_file_end(struct mcap_file *f, const muster_RunStatus *status);

/** @return MU_OK, or MU_FAULT_OS when the file is not whole, said on standard error */
MU_MUST_USE mu_result mcap_file_close(struct mcap_file *f);

/*
 * The state of all bodies as a file.
 */

/**
 * Makes a file of these bytes below a folder.  Who may speak to the simulator may not for that
 * write where he likes: nothing that is there is replaced, and neither ".." nor a link leads out.
 *
 * @param folder  an open one
 * @param path    from there on
 * @return MU_OK, or MU_FAULT_OS: errno says why, EXDEV that it leads out; no file is left
 */
MU_MUST_USE mu_result snapshot_file_write(int folder, const char *path, const unsigned char *bytes,
                                          size_t count);

/**
 * Lets an engine go on from a file.  Takes start-up memory.
 *
 * @return MU_OK, or MU_FAULT_FILE, explained on standard error
 */
MU_MUST_USE mu_result snapshot_file_restore(struct engine *e, const char *path);

#endif
