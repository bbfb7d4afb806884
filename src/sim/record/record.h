/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file record.h
 * What is kept of a run: its hash, tracks, recording, Scene, Frames, totals, snapshots and orders.
 */
#ifndef MUSTER_SIM_RECORD_H
#define MUSTER_SIM_RECORD_H

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
 * The hash of a run: SHA-256 over everything that happened, in a fixed order.
 *
 * Each act is digested when it arrives.  When the step is complete the digests are folded in the
 * order of the agents, so the order of arrival does not show.
 */

enum { RUN_HASH_BYTES = 32, RUN_HASH_TEXT = 65 };

struct run_hash; /* one in a process */

/** Starts a run's hash; takes memory at start-up. */
struct run_hash *run_hash_open(void);

/** Digests what an agent did: command, rules fired, mails sent. */
void run_hash_act(struct run_hash *h, const muster_Act *act, unsigned char digest[RUN_HASH_BYTES]);

/** Folds bytes in, such as digests. */
void run_hash_fold(struct run_hash *h, const void *bytes, size_t count);

/** Folds the bits of a body's state in, each number from its lowest byte, whatever the processor's
 * order is. */
void run_hash_fold_doubles(struct run_hash *h, const double values[], size_t count);

/** Folds a number in, the same on every machine. */
void run_hash_fold_number(struct run_hash *h, uint64_t number);

/** Folds an order in that changed the world: its kind, its body and its numbers. */
void run_hash_order(struct run_hash *h, const muster_RunCommand *order);

/** Digests the mails that came from outside the roster in one step. */
void run_hash_outside(struct run_hash *h, const muster_Mail *mails, uint32_t count,
                      unsigned char digest[RUN_HASH_BYTES]);

/** @return the first 64 bits of the hash, if the run ended here */
uint64_t run_hash_peek(struct run_hash *h);

/** Ends the hash: 64 hexadecimal digits. */
void run_hash_end(struct run_hash *h, char text[RUN_HASH_TEXT]);

/*
 * Statistics of a robot since the run began: distance, number of stalls, stalled time.
 *
 * They are computed from the rounded numbers of run.csv, as the report does, so that both agree.
 */

/* Zero before the first step. */
struct tally {
    double distance_m, stalled_s;
    uint32_t stalls; /* how many times a stall began */
    bool seen, stalled;
    double x_m, y_m, time_s; /* of the last step, as in run.csv */
};

/**
 * Adds a step.
 *
 * @param time_ns  simulated, of this step
 * @param step_ns  how long a stall in the first step lasts
 */
void tally_take(struct tally *t, uint64_t time_ns, uint64_t step_ns,
                const struct engine_sample *sample);

/* The Scene: what stands in a world.  Observers draw each Frame on it. */

/**
 * Makes the Scene of a world; takes memory at start-up.
 *
 * Poses are those of the start.  The caller sets simulator, seed, step_ns, and which robots are
 * controlled.
 *
 * @return the sample, which points into the world
 */
muster_Scene *scene_make(const struct world *world);

/*
 * The queue of orders: changes of the world from outside.  An order waits for the end of its step,
 * for a time or for a condition.  Due orders are carried out by source and sequence number, so
 * their order of arrival within a step does not show.
 */

enum { ORDER_FILE_MAX = 1023 };

/* A command with strings of its own. */
struct order {
    muster_RunCommand command; /* its strings are those below; simulator is NULL */
    char source[MU_PROCESS_MAX + 1], name[MU_FIELD_MAX + 1], file[ORDER_FILE_MAX + 1];
    char when[MU_CONDITION_MAX + 1];
};

/** Copies a command with its strings.  The copy must not move: it points into itself. */
void order_copy(struct order *to, const muster_RunCommand *command);

struct order_queue; /* one in a process */

/** Takes memory at start-up. */
struct order_queue *order_queue_open(const struct condition_names *names);

/**
 * Keeps a copy of a command.
 *
 * @param why  CONDITION_WHY_MAX bytes: the reason when the command is not kept
 * @return MU_OK; MU_MALFORMED: its condition has a mistake; MU_FULL: MU_ORDERS_MAX are due, or
 *         MU_ORDERS_LATER_MAX wait
 */
MU_MUST_USE mu_result order_queue_put(struct order_queue *q, const muster_RunCommand *command,
                                      char *why);

/** Notes what an agent with a body did in this step, for conditions. */
void order_queue_note_act(struct order_queue *q, int robot, const muster_Act *act);

/** Finds the orders that are due.  Call it at the end of a step, before the world changes. */
void order_queue_look(struct order_queue *q, uint64_t time_ns, const struct condition_view *view);

/** @return the next order that is due, good until the next call; NULL: none is */
const muster_RunCommand *order_queue_take(struct order_queue *q);

/*
 * Events: a CSV file of the times at which conditions come true.  A state counts when it begins, a
 * mail or a rule in each step that has one.
 */

struct events; /* one in a process */

/** @return the number of a body: the robots, then the objects; -1: the world has none of that name
 */
int record_find_body(const struct world *world, const char *name);

/** @return the names that conditions may use.  The world and the names of agents must outlive them.
 */
struct condition_names record_names(const struct world *world, const struct mu_option_list *agents);

/** Notes for a condition what a robot did in this step, or CONDITION_AGENTS and more: an agent. */
void record_note_act(struct condition_watch *w, int agent, const muster_Act *act);

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

/** Checks all conditions.  Call it at the end of a step, before the world changes. */
void events_look(struct events *e, uint64_t time_ns, const struct condition_view *view);

/** @return MU_OK, or MU_FAULT_OS when the file is not whole, said on standard error */
MU_MUST_USE mu_result events_close(struct events *e);

/*
 * The builder of a Frame: a whole step, as observers see it.
 *
 * It has no clock and no network.  It copies into memory taken at start-up, and counts what does
 * not fit.
 */

struct frame_builder; /* one in a process */

/** Takes memory at start-up.  @param simulator  its name; must outlive the builder
 *  @param agents  how many agents without a body it has */
struct frame_builder *frame_open(const struct world *world, const char *simulator, size_t agents);

/** Begins the Frame of a step: without percepts and orders.  Acts stay until frame_clear. */
void frame_begin(struct frame_builder *v, int64_t step, uint64_t time_ns);

/** Sets the pose, motion and statistics of a robot. */
void frame_take_body(struct frame_builder *v, size_t robot, const struct engine_sample *sample,
                     const struct tally *tally);

/** Sets the pose of an object. */
void frame_take_object(struct frame_builder *v, size_t object, struct world_pose pose);

/** Adds the percept of a robot.  Its lists must live until the Frame is used. */
void frame_add_percept(struct frame_builder *v, const muster_Percept *percept);

/** Adds what an agent did.  Agents without a body have numbers behind the robots.  A Frame has its
 * acts in the order of these numbers, and those of one agent as they came. */
void frame_add_act(struct frame_builder *v, size_t robot, const muster_Act *act);

/** Keeps mails from outside for the Frame of that step. */
void frame_add_outside(struct frame_builder *v, int64_t step, const muster_Mail *mails,
                       uint32_t count);

/** Adds an order that was carried out. */
void frame_add_order(struct frame_builder *v, const muster_RunCommand *order);

/** @return the entry of a robot.  The caller sets its state, commands and counters. */
muster_RobotView *frame_robot(struct frame_builder *v, size_t robot);

/** @return the entry of an agent without a body.  The caller sets all of it; the name is only read.
 */
muster_AgentView *frame_agent(struct frame_builder *v, size_t agent);

/** @return the Frame, good until the next call of any of these.  The caller sets digest and
 * wall_ns. */
muster_Frame *frame_finish(struct frame_builder *v);

/** Forgets the acts. */
void frame_clear(struct frame_builder *v);

/** @return how many acts and mails were left out since the beginning */
uint64_t frame_left_out(const struct frame_builder *v);

/*
 * Tracks: run.csv has a row for each robot and control step.  placements.csv beside it has a row
 * for each time that a robot was placed; it exists only if one was.
 */

struct tracks; /* one in a process */

/** Creates the file and writes its head.  @return MU_OK or MU_FAULT_OS, said on standard error */
MU_MUST_USE mu_result tracks_open(struct tracks **out, const char *path);

/** Adds a row.  tracks_close reports a full disk. */
void tracks_add(struct tracks *r, uint64_t time_ns, const char *robot,
                const struct engine_sample *sample);

/** @return MU_OK, or MU_FAULT_OS when the file is not whole, said on standard error */
MU_MUST_USE mu_result tracks_close(struct tracks *r);

/*
 * The recording, run.mcap: files of the run, the Scene, the Frame of each step, how it ended.
 *
 * docs/recording.md describes it.  Messages are sorted by simulated time.  A step copies its bytes
 * into memory, which goes to the system once a second or a megabyte.  A full disk ends the
 * recording, and not the run.
 */

struct mcap_file; /* one in a process */

struct mcap_file_options {
    const char *path;
    const struct world *world; /* its files are attached as "world/..." if command is set */
    const struct mu_option_list *files;  /* "NAME=PATH": attached as NAME */
    const struct mu_option_list *notes;  /* "KEY=VALUE": of the table "run" */
    const struct mu_option_list *places; /* of robots: noted if command is set */
    bool without_percepts;
    const char *command; /* of a run by hand; NULL: `muster run` attaches the rest */
    bool free;
    uint64_t seed;
    double duration_s;
};

/**
 * Creates the file, with its attachments and notes.  Warns on standard error of a file that it
 * cannot attach.
 *
 * @return MU_OK; MU_FAULT_OS: the file cannot be created, said on standard error
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

/* Snapshots: the state of all bodies as a file. */

/**
 * Creates a file below a folder.  The path comes from the network, so a file that exists is not
 * replaced, and neither ".." nor a link leads out of the folder.
 *
 * @param folder  open
 * @param path    relative to it
 * @return MU_OK, or MU_FAULT_OS: errno says why, EXDEV that the path leads out; no file is left
 */
MU_MUST_USE mu_result snapshot_file_write(int folder, const char *path, const unsigned char *bytes,
                                          size_t count);

/**
 * Sets an engine to the state in a file.  Takes memory at start-up.
 *
 * @return MU_OK, or MU_FAULT_FILE, explained on standard error
 */
MU_MUST_USE mu_result snapshot_file_restore(struct engine *e, const char *path);

#endif
