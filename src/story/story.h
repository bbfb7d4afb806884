/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file story.h
 * A recorded run: its steps, what went on in its minds, why a robot acted, and where two runs part.
 */
#ifndef MUSTER_STORY_STORY_H
#define MUSTER_STORY_STORY_H

#include "core/table.h"
#include "core/text.h"
#include "mcap/mcap.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* --- interventions.c -------------------------------------------------------------------------- */

/*
 * Manual changes of a recorded robot: pushes, placements, resets, sensors switched on and off.
 *
 * Pure: orders are added in the order of steps, then anything can be asked of any step.  The last
 * INTERVENTIONS_MAX are kept.
 */

enum { INTERVENTIONS_MAX = 4096 };

struct intervention {
    uint32_t step; /* it was carried out at the end of this one */
    muster_RunOrder order;
    char robot[MU_NAME_MAX + 1]; /* "": every one */
    char source[MU_NAME_MAX + 1];
    double x_m, y_m, force_x_n, force_y_n, torque_nm, time_s; /* as in RunCommand */
    uint32_t senses;
    bool on;
};

struct interventions {
    size_t count; /* so far; the ring holds the last INTERVENTIONS_MAX */
    struct intervention at[INTERVENTIONS_MAX];
};

/** Adds what an order of a step did to a body; other orders are passed over. */
void interventions_add(struct interventions *h, uint32_t step, const muster_RunCommand *order);

/* Which are asked for. */
struct interventions_asked {
    const char *robot;
    uint32_t since, step; /* what was done to it from the end of one on, and before another */
    bool sensed;          /* also what of its sensors is off then */
    double step_s;        /* simulated time of a step */
};

/**
 * Adds a line for each: placements, and pushes that were under way or ended at most a second
 * before.
 *
 * @param before  what each line begins with
 * @return how many lines
 */
size_t interventions_tell(const struct interventions *h, const struct interventions_asked *on,
                          const char *before, struct mu_text *out);

/* --- minds.c ---------------------------------------------------------------------------------- */

/*
 * What went on in the minds of a recorded run, out of their diaries (docs/reference/frame.md).
 *
 * Pure: diaries are added in the order of steps, then anything can be asked of any step.  All
 * memory is taken by minds_open.  One thread.
 */

/* No line. */
enum { MINDS_NONE = -1 };

/* A line of a diary.  Lines of a robot are a list, by their order. */
struct minds_line {
    uint32_t at, bytes; /* its text without the letter, and without the end of the line */
    uint32_t step;
    int32_t robot;
    int32_t before;   /* of the same robot */
    int32_t cause;    /* the line with a capital letter above it; its own: it is one */
    int32_t end;      /* of a fact: the line with which it went; MINDS_NONE: it stands */
    int32_t below[2]; /* of a fact that stands: others that do, by the next bit of their indices */
    char letter;
    long long fact; /* of + and -: its index */
};

struct minds_robot {
    char *name;
    int32_t first, last;
    int32_t stands; /* facts that stand at the end: the root of their tree */
    int32_t cause;  /* of what comes next */
    int32_t sensed; /* the last percept */
    uint64_t lost;  /* lines that its diary had no room for */
};

/* So many lines together, of all robots: which may be passed over when facts are looked for. */
enum { MINDS_BLOCK = 256 };

struct minds_block {
    int32_t stands; /* facts of it that stand at the end */
    int32_t end;    /* the last line with which one of the others went; 0: none has */
};

struct minds {
    char *text;
    size_t text_len, text_max;
    struct minds_line *lines;
    int32_t lines_count, lines_max;
    struct minds_block *blocks; /* one for each MINDS_BLOCK lines */
    struct minds_robot *robots;
    int32_t robots_count, robots_max;
    struct mu_table names;
    bool cut; /* there was no room for all of it */
};

/**
 * Takes the memory for diaries of text_max bytes together; pages that stay empty cost nothing.
 *
 * @param robots_max  robots at most, 1 or more
 */
struct minds *minds_open(size_t text_max, uint32_t robots_max);

/** Forgets all of it. */
void minds_clear(struct minds *m);

/** Adds a robot's diary of one step; steps come in order.  What is not a diary's line is skipped.
 */
void minds_add(struct minds *m, const char *robot, uint32_t step, const char *diary);

/** @return the robot of that name, or MINDS_NONE: it has no diary */
int32_t minds_robot(const struct minds *m, const char *name);

/** @return a line's text, without letter and index; *bytes: its length */
const char *minds_text(const struct minds *m, int32_t line, size_t *bytes);

/** @return the last line of a robot up to the end of a step, or MINDS_NONE */
int32_t minds_at(const struct minds *m, int32_t robot, uint32_t step);

/**
 * Goes through the facts that stood behind a line, the oldest first.
 *
 * @param line  from minds_at; MINDS_NONE: there was none
 * @param from  the fact before, or MINDS_NONE for the first
 * @return the line that asserted it, or MINDS_NONE: there is no other
 */
int32_t minds_next_fact(const struct minds *m, int32_t line, int32_t from);

/** @return the line that asserted the fact that stood behind a line, or MINDS_NONE */
int32_t minds_fact(const struct minds *m, int32_t line, long long index);

/** @return the last line with that letter up to a line, or MINDS_NONE */
int32_t minds_last(const struct minds *m, int32_t line, char letter);

/* --- recording.c ------------------------------------------------------------------------------ */

/*
 * A recorded run: its scene, any of its steps, and what went on in its minds.
 *
 * A recording is read through once when it is opened; then any step can be asked for.  Memory is
 * taken when it is created; samples are DDS's.  One thread.
 */

/* Where a step is found. */
struct recording_step {
    int64_t step;
    uint64_t log_ns;
};

/* How a recorded run ended. */
enum recording_end {
    RECORDING_DONE,    /* with its last step */
    RECORDING_STOPPED, /* before: it was ended.  The last Frame is how the world was left */
    RECORDING_FAULT, /* before: a process was silent, say.  The last Frame is a step like others */
    RECORDING_CUT    /* not known.  The last Frame is one or the other */
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
    const char *foreign; /* a topic of another type than this version's; NULL: none was met */
};

/** Takes the memory for a recording.  @return MU_OK; MU_FAULT_FILE: there is no such file */
MU_MUST_USE mu_result recording_create(struct recording *r, const char *path,
                                       struct mu_fault *fault);

/**
 * Opens it, or another one that is no longer, and reads it through; what was open is closed.
 *
 * @return MU_OK; MU_FAULT_FILE: not a recording of a run, or of another version's types: see
 *         `foreign`
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

/* --- differ.c --------------------------------------------------------------------------------- */

/* Where two recordings of one run part: the first step, the agent, and the value. */

enum { DIFFER_WHAT_MAX = 64, DIFFER_VALUE_MAX = 160 };

struct difference {
    int64_t step;
    char who[MU_NAME_MAX + 1]; /* a robot, an object, a sender; "": the run */
    char what[DIFFER_WHAT_MAX];
    char one[DIFFER_VALUE_MAX], other[DIFFER_VALUE_MAX]; /* the values; long ones are cut */
};

/**
 * Compares two recordings from their first steps on: poses and motion bit by bit, commands, mails,
 * rules fired, what came from outside, and minds' diaries where both have them.
 *
 * @param one  of a run that did not come to its end: then its last Frame is compared for how the
 *     world was left, and what the other has beyond it is no difference.  If both broke off, the
 *     other may lack that Frame
 * @param d  out: the first difference
 * @return false: there is none
 */
bool differ_find(struct recording *one, struct recording *other, struct difference *d);

/** Compares one step's Frames.  @return as differ_find */
bool differ_frames(const muster_Frame *one, const muster_Frame *other, struct difference *d);

/* --- stalls.c --------------------------------------------------------------------------------- */

/* When a recorded robot was stalled, where, beside what, and told what. */

/* From the first step that found it stalled to the last. */
struct stall {
    int64_t from, to;
    double x_m, y_m;                          /* where it began */
    double forward_m_s, turn_rad_s;           /* what its motors had been told */
    muster_State state;                       /* that it was in then */
    char near[MU_NAME_MAX + sizeof "a wall"]; /* what was nearest: a robot, or "a wall" */
    double near_m;                            /* from its middle to that robot's, or to the wall */
};

/**
 * Finds the stalls of a robot.
 *
 * @param robot  in every Frame; MU_NONE: an agent without a body, which has none
 * @param most  room for so many
 * @return how many there are, more than most if there was no room; the first are filled
 */
size_t stalls_find(struct recording *r, uint32_t robot, struct stall *stalls, size_t most);

/** @return the stall that a step is in, or the next one to it; NULL: there is none */
const struct stall *stalls_at(const struct stall *stalls, size_t count, int64_t step);

/** @return a robot's index in every Frame, or MU_NONE */
uint32_t stalls_robot(struct recording *r, const char *name);

/* --- why.c ------------------------------------------------------------------------------------ */

/*
 * Why a robot did what it did: from a speed, a mail or a fact back to what was sensed, said or
 * commanded.  Pure.
 */

/* Where a chain ends. */
enum why_end {
    WHY_SENSED = 1,       /* a percept */
    WHY_MAIL = 2,         /* a mail of an agent without a trace */
    WHY_LINE = 4,         /* a line from a console */
    WHY_EVENT = 8,        /* something in the agent's life, such as on-run */
    WHY_RULES = 16,       /* what the rule file says at the start */
    WHY_UNKNOWN = 32,     /* the diary had no room for it */
    WHY_INTERVENTION = 64 /* a push, a placement, a sensor that was switched off */
};

struct why {
    const struct minds *minds;
    const struct interventions *interventions;
    double step_s; /* simulated time of a step */
    struct mu_text *out;
};

/**
 * Adds the chain of the speed that a robot's motors had at a step, an indented line each, and the
 * manual changes of the body since the speed was set.
 *
 * @return ends, bits of enum why_end; 0: no speed was ever set, and there was no manual change
 */
uint32_t why_speed(const struct why *w, int32_t robot, uint32_t step);

/** The same of a fact that stood at the end of a step; 0: there was none of that index. */
uint32_t why_fact(const struct why *w, int32_t robot, uint32_t step, long long index);

#endif
