/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file json.h
 * What the page reads: JSON of a scene, its frames, the run, and minds.
 */
#ifndef MUSTER_WEB_JSON_H
#define MUSTER_WEB_JSON_H

#include "core/json.h"
#include "core/table.h"
#include "core/text.h"
#include "muster/limits.h"
#include "story/story.h"
#include "wire.h"

#include <stddef.h>
#include <stdint.h>

/* --- scene_json.c ----------------------------------------------------------------------------- */

/* A Scene as the page reads it: metres and radians, points as lists of numbers.  Pure. */

/** Writes all of it into a text, which is cut when it has no room. */
void scene_json_write(struct mu_text *text, const muster_Scene *scene);

/* --- beams.c ---------------------------------------------------------------------------------- */

/*
 * Readings of a sonar or laser for the page: two characters each, whole centimetres.
 *
 * A reading is 64 times the place of its first character in BEAMS_DIGITS and the place of its
 * second.  Twenty times a second a hundred robots have thousands of them; as decimal numbers
 * they would be most of what is sent.
 */

#define BEAMS_DIGITS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"

enum {
    BEAMS_SHOWN_MAX = 181, /* of one sensor; of more, each second, third, ... is shown */
    BEAMS_FAR_CM = 4095,   /* and further, and what is no number */
    BEAMS_TEXT = 2 * BEAMS_SHOWN_MAX + 1
};

/** Writes count readings, or as many of them, evenly, as are shown.  @return how many */
size_t beams_write(char text[BEAMS_TEXT], const float *range_m, size_t count);

/* --- frame_json.c ----------------------------------------------------------------------------- */

/*
 * A Frame as the page reads it: numbers in the order of the Scene, whole millimetres, milliradians
 * and milliseconds; of what agents said, as much as a person can take in.
 *
 *     robots    [x, y, heading, forward, turn, told forward, told turn, flags], ...
 *               flags: the state, 8 if stalled, 16 if the simulator had to put it back
 *     objects   [x, y, heading], ...
 *     sonar     [robot's index, beams], ...        see beams.c
 *     laser     likewise
 *     fired     [robot's index, how many, rules], ...
 *     mails     [from, to, performative, content], ...
 *     goals     what each robot wants, "" for one that does not say; empty when none does
 *     orders    [source, order, name], ...
 *
 * Pure.
 */

enum {
    FRAME_JSON_MAILS_MAX = 64,   /* shown of a step */
    FRAME_JSON_CONTENT_MAX = 96, /* bytes shown of a mail */
    FRAME_JSON_RULES_MAX = 240   /* of the rules that a robot fired */
};

/** Writes one object.  @param key  NULL: it has none.  @param lean  with empty lists of readings */
void frame_json_write(struct mu_json *j, const char *key, const muster_Frame *frame, bool lean);

/**
 * Writes the totals of a Frame as one object:
 *
 *     robots    [distance, stalls, stalled, firings, sent, received], ...    mm, ms
 */
void frame_json_totals(struct mu_json *j, const char *key, const muster_Frame *frame);

/** Writes a mail of a step as [step, from, to, performative, content]. */
void frame_json_mail(struct mu_json *j, int64_t step, const muster_Mail *mail);

/* --- run_json.c ------------------------------------------------------------------------------- */

/* How the run goes, as the page reads it. */

enum { RUN_JSON_WAITS_MAX = 255, RUN_JSON_REPORT_MAX = 1023 };

/* One of a run's brokers, and its mails.  Of one that has died they count on. */
struct run_broker {
    char name[MU_NAME_MAX + 1]; /* "": free */
    bool there;
    uint64_t sent, delivered, waiting, expired, refused;
};

/* What is kept of RunStatus, BrokerStatus and Beacon, whose samples go back to the bus. */
struct run_json {
    char simulator[MU_PROCESS_MAX + 1]; /* "": none, or it is gone and its run had not ended */
    muster_RunState state;
    int64_t step;
    uint64_t time_ns, wall_ns, duration_ns, skipped;
    char hash[65];
    char waits_for[RUN_JSON_WAITS_MAX + 1];
    char report[RUN_JSON_REPORT_MAX + 1]; /* the folder of its report; "": it has not ended, or
                                             was not ours */
    struct run_broker brokers[MU_BROKERS_MAX];
};

/** @return whether a simulator is there whose run has not ended */
bool run_json_lives(const struct run_json *r);

/** @return whether the last run that was heard of has ended */
bool run_json_has_ended(const struct run_json *r);

/** Keeps what a status says. */
void run_json_take(struct run_json *r, const muster_RunStatus *status);

/** A simulator is gone; how its run has ended is still to be seen. */
void run_json_lose(struct run_json *r, const char *simulator);

/** Keeps what a broker says of its mails. */
void run_json_mails(struct run_json *r, const muster_BrokerStatus *status);

/** A broker is there, or no longer. */
void run_json_broker(struct run_json *r, const char *name, bool there);

/** Another run begins: brokers that are gone were those of the one before. */
void run_json_begin(struct run_json *r);

/** Writes one object; broker is one that is there, mails are those of all. */
void run_json_write(struct mu_json *j, const struct run_json *r);

/* --- mind_json.c ------------------------------------------------------------------------------ */

/*
 * What was in a robot's mind at a step of a recording, as the page reads it:
 *
 *     robot     its name
 *     step      of the last line of its diary up to then; -1: there is none
 *     facts     ["f-12", "(goal wander)"], ...    those that stood, the oldest first
 *     agenda    ["see", "12,9"], ...              rule, and the facts that it would fire on
 *     fired     [step, "see", "12,9"], ...        the last ones, the latest first
 *     mails     [step, "blue tell near 2000.0", sent], ...    likewise; sent: else it came
 *
 * Pure.
 */

enum {
    MIND_JSON_FACTS_MAX = 1000,
    MIND_JSON_FIRED_MAX = 20,
    MIND_JSON_MAILS_MAX = 20,
    MIND_JSON_TEXT_MAX = 400 /* bytes of a fact or mail that are shown */
};

/** Writes one object. */
void mind_json_write(struct mu_json *j, const char *key, const struct minds *minds,
                     const char *robot, uint32_t step);

/* --- pages.c ---------------------------------------------------------------------------------- */

/*
 * The white pages, as brokers publish them for watchers: a process without an agent is told no
 * others. Pure.
 */

enum { PAGES_LINES_MAX = 2048, PAGES_WORD_MAX = 15 };

struct pages_line {
    char name[MU_NAME_MAX + 1]; /* "": free */
    char kind[PAGES_WORD_MAX + 1], state[PAGES_WORD_MAX + 1];
    char host[MU_FIELD_MAX + 1];
    char reason[MU_FIELD_MAX + 1]; /* why it is in that state; "": it did not say */
    char broker[MU_NAME_MAX + 1];  /* the agent that said it last, */
    uint32_t part;                 /* in this part of its pages */
    uint64_t turn;                 /* when */
};

struct pages {
    struct pages_line lines[PAGES_LINES_MAX];
    uint32_t count;        /* places that were ever taken */
    struct mu_table names; /* to places */
    uint64_t turn;
    uint64_t refused; /* lines that found no place, or were none */
};

/** Takes the memory, at start-up. */
void pages_init(struct pages *p);

/** Takes one part: it takes the place of what its broker said in it before. */
void pages_take(struct pages *p, const muster_Page *page);

/**
 * Writes them as one object: a list of [name, kind, state, host, reason], in the order in which
 * they came; without those that only look.
 */
void pages_write(struct mu_json *j, const struct pages *p);

#endif
