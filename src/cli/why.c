/* SPDX-License-Identifier: Apache-2.0 */
/* muster why: from a stall, a speed or a fact of a recording back to what was sensed, or said. */
#include "story/story.h"

#include "cli/verbs.h"
#include "core/exits.h"
#include "core/json.h"
#include "core/options.h"
#include "muster/memory.h"

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { STALLS_MAX = 4096, CHAIN_BYTES = 256 * 1024 };

enum ask_about { ASK_STALLS, ASK_STALL, ASK_SPEED, ASK_FACT };

struct ask {
    const char *file, *robot;
    enum ask_about about;
    double time_s;
    long long fact;
    bool json;
};

static struct ask ask;

static struct mu_option option_table[] = {MU_FLAG("json", ask.json, "one object per line")};

static const char *const states[] = {[muster_STATE_STANDBY] = "standby",
                                     [muster_STATE_RUNNING] = "running",
                                     [muster_STATE_SUSPENDED] = "suspended",
                                     [muster_STATE_MOVING] = "moving",
                                     [muster_STATE_ABSENT] = "absent"};

/* --- what is asked ---------------------------------------------------------------------------- */

/* The youngest recording that a run has left here. */
static const char *file_default(void)
{
    glob_t found;
    const char *best = NULL;
    time_t best_time = 0;
    if (glob("out/*/run.mcap", 0, NULL, &found) != 0) {
        return NULL;
    }
    for (size_t i = 0; i < found.gl_pathc; i++) {
        struct stat s;
        if (stat(found.gl_pathv[i], &s) == 0 && (!best || s.st_mtime > best_time)) {
            best_time = s.st_mtime;
            best = found.gl_pathv[i];
        }
    }
    best = best ? mu_startup_string(best) : NULL;
    globfree(&found);
    return best;
}

/* 41.2, speed@41.2, stalled@41.2, f-12@41.2 */
static bool moment_parse(const char *word, struct ask *a)
{
    char *end;
    const char *at = strchr(word, '@');
    a->about = ASK_SPEED;
    if (at && strncmp(word, "stalled@", 8) == 0) {
        a->about = ASK_STALL;
    } else if (at && strncmp(word, "f-", 2) == 0) {
        a->about = ASK_FACT;
        a->fact = strtoll(word + 2, &end, 10);
        if (end == word + 2 || end != at || a->fact < 0) {
            return false;
        }
    } else if (at && strncmp(word, "speed@", 6) != 0) {
        return false;
    }
    const char *number = at ? at + 1 : word;
    a->time_s = strtod(number, &end);
    return end != number && !*end && isfinite(a->time_s) && a->time_s >= 0;
}

static bool is_file(const char *word)
{
    size_t len = strlen(word);
    return strchr(word, '/') || (len > 5 && strcmp(word + len - 5, ".mcap") == 0);
}

static mu_result words_take(const struct mu_options *o, struct ask *a)
{
    size_t next = 0;
    if (o->words_count > 0 && is_file(o->words[0])) {
        a->file = o->words[next++];
    }
    size_t left = o->words_count - next;
    if (left < 1 || left > 2 || (left == 2 && !moment_parse(o->words[next + 1], a))) {
        fprintf(stderr, "muster why: expected [FILE] ROBOT [stalled@S, S or f-N@S], for example: "
                        "muster why red stalled@41.2\n");
        return MU_FAULT_USAGE;
    }
    a->robot = o->words[next];
    if (!a->file) {
        a->file = file_default();
        fprintf(stderr, "muster why: %s\n",
                a->file ? a->file : "there is no out/*/run.mcap here; name a recording");
    }
    return a->file ? MU_OK : MU_FAULT_FILE;
}

/* --- answers ---------------------------------------------------------------------------------- */

struct teller {
    struct recording recording;
    struct why why;
    struct mu_text chain;
    uint32_t robot; /* in Frames; MU_NONE: it has no body */
    int32_t mind;   /* MINDS_NONE: it has no diary */
    struct stall stalls[STALLS_MAX];
    size_t stalls_count;
};

static double seconds(const struct teller *t, int64_t step)
{
    return (double)step * t->why.step_s;
}

static void stall_print(const struct teller *t, const struct stall *s)
{
    printf("%s stalled from %.1f s to %.1f s at (%.2f, %.2f) m", ask.robot, seconds(t, s->from),
           seconds(t, s->to + 1), s->x_m, s->y_m);
    if (s->near[0]) {
        printf("; nearest to its middle: %s, %.2f m", s->near, s->near_m);
    }
    printf("\n");
}

static void motors_print(const struct stall *s)
{
    printf("  its motors were told %.3f m/s, %.1f deg/s", s->forward_m_s,
           s->turn_rad_s * 180 / M_PI);
    printf(s->state == muster_STATE_RUNNING ? "\n" : " because it was %s\n", states[s->state]);
}

/* What the chain ends in. */
static void ends_json(struct mu_json *j, uint32_t ends)
{
    static const char *const names[] = {"sensed", "mail",    "line",        "event",
                                        "rules",  "unknown", "intervention"};
    mu_json_list(j, "ends");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (ends & 1u << i) {
            mu_json_string(j, NULL, names[i]);
        }
    }
    mu_json_end(j);
}

static void stall_json(const struct teller *t, const struct stall *s, uint32_t ends)
{
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "robot", ask.robot);
    mu_json_string(&j, "event", "stalled");
    mu_json_real(&j, "from_s", seconds(t, s->from));
    mu_json_real(&j, "to_s", seconds(t, s->to + 1));
    mu_json_real(&j, "x_m", s->x_m);
    mu_json_real(&j, "y_m", s->y_m);
    mu_json_string(&j, "near", s->near);
    mu_json_real(&j, "near_m", s->near[0] ? s->near_m : 0);
    mu_json_string(&j, "state", states[s->state]);
    ends_json(&j, ends);
    mu_json_string(&j, "chain", t->chain.at);
    mu_json_end(&j);
}

static void chain_print(struct teller *t)
{
    const char *line = t->chain.at;
    while (*line) {
        size_t len = strcspn(line, "\n");
        printf("  %.*s\n", (int)len, line);
        line += len + (line[len] == '\n');
    }
}

/* A stall that a step finds came of what was set up to the step before. */
static void stall_tell(struct teller *t, const struct stall *s)
{
    mu_text_clear(&t->chain);
    uint32_t before = s->from > 0 ? (uint32_t)s->from - 1 : 0;
    uint32_t ends = t->mind == MINDS_NONE ? 0 : why_speed(&t->why, t->mind, before);
    if (t->mind != MINDS_NONE && ends == 0) {
        mu_text_add(&t->chain, "no rule has ever set a speed: another body has pushed it\n");
    }
    if (ask.json) {
        stall_json(t, s, ends);
        return;
    }
    stall_print(t, s);
    motors_print(s);
    chain_print(t);
}

static void stalls_tell(struct teller *t)
{
    size_t known = t->stalls_count < STALLS_MAX ? t->stalls_count : STALLS_MAX;
    if (ask.json) {
        for (size_t i = 0; i < known; i++) {
            stall_tell(t, &t->stalls[i]);
        }
        return;
    }
    printf("%s was stalled %zu time%s\n", ask.robot, t->stalls_count,
           t->stalls_count == 1 ? "" : "s");
    for (size_t i = 1; i < known; i++) {
        stall_print(t, &t->stalls[i]);
    }
    if (known > 0) {
        printf("the first:\n");
        stall_tell(t, &t->stalls[0]);
    }
}

static void chain_tell(struct teller *t, int64_t step, uint32_t ends)
{
    if (!ask.json) {
        bool beyond = ask.time_s > seconds(t, step + 1);
        printf("%s at %.1f s%s\n", ask.robot, seconds(t, step),
               beyond ? ", where the recording ends" : "");
        chain_print(t);
        return;
    }
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "robot", ask.robot);
    mu_json_real(&j, "time_s", seconds(t, step));
    ends_json(&j, ends);
    mu_json_string(&j, "chain", t->chain.at);
    mu_json_end(&j);
}

static void moment_tell(struct teller *t)
{
    int64_t step = recording_step_at(&t->recording, ask.time_s);
    uint32_t ends = ask.about == ASK_FACT ? why_fact(&t->why, t->mind, (uint32_t)step, ask.fact)
                                          : why_speed(&t->why, t->mind, (uint32_t)step);
    if (ends == 0) {
        mu_text_add(&t->chain, ask.about == ASK_FACT ? "it had no such fact\n"
                                                     : "no rule had set a speed yet\n");
    }
    chain_tell(t, step, ends);
}

static void name_add(struct mu_text *names, const char *name)
{
    mu_text_add(names, names->len > 0 ? ", " : "");
    mu_text_add(names, name);
}

/* Bodies, and minds without one: clones, and agents that were launched. */
static void robots_name(struct teller *t, struct mu_text *names)
{
    const struct minds *m = t->recording.minds;
    recording_rewind(&t->recording);
    const muster_Frame *f = recording_next(&t->recording);
    for (uint32_t i = 0; f && i < f->robots._length; i++) {
        name_add(names, f->robots._buffer[i].name);
    }
    for (int32_t i = 0; i < m->robots_count; i++) {
        if (stalls_robot(&t->recording, m->robots[i].name) == MU_NONE) {
            name_add(names, m->robots[i].name);
        }
    }
}

static void nobody_explain(struct teller *t)
{
    char shown[MU_TEXT_SHOWN], bytes[1024];
    struct mu_text names = mu_text_in(bytes, sizeof bytes);
    robots_name(t, &names);
    fprintf(stderr, "muster why: %s has no robot named %s; it has %s%s\n", ask.file,
            mu_text_show(shown, ask.robot), names.len > 0 ? names.at : "no step",
            names.cut ? "..." : "");
}

static mu_result ask_answer(struct teller *t)
{
    if (t->mind == MINDS_NONE && ask.about != ASK_STALLS) {
        fprintf(stderr,
                "muster why: %s has no diary of %s's mind: it is there with --record full, "
                "without --no-diary, and of robots with rules\n",
                ask.file, ask.robot);
        return MU_FAULT_FILE;
    }
    if (ask.about == ASK_SPEED || ask.about == ASK_FACT) {
        moment_tell(t);
        return MU_OK;
    }
    t->stalls_count = stalls_find(&t->recording, t->robot, t->stalls, STALLS_MAX);
    size_t known = t->stalls_count < STALLS_MAX ? t->stalls_count : STALLS_MAX;
    const struct stall *s =
        stalls_at(t->stalls, known, recording_step_at(&t->recording, ask.time_s));
    if (ask.about == ASK_STALLS) {
        stalls_tell(t);
    } else if (s) {
        stall_tell(t, s);
    } else if (!ask.json) {
        printf("%s was never stalled\n", ask.robot);
    }
    return MU_OK;
}

static mu_result teller_open(struct teller *t, struct mu_fault *fault)
{
    static char bytes[CHAIN_BYTES];
    mu_text_init(&t->chain, bytes, sizeof bytes);
    MU_TRY(recording_create(&t->recording, ask.file, fault));
    MU_TRY(recording_open(&t->recording, ask.file, fault));
    t->why = (struct why){.minds = t->recording.minds,
                          .interventions = t->recording.interventions,
                          .step_s = (double)t->recording.step_ns * 1e-9,
                          .out = &t->chain};
    t->robot = stalls_robot(&t->recording, ask.robot);
    t->mind = minds_robot(t->recording.minds, ask.robot);
    return MU_OK;
}

int why_verb(int argc, char **argv)
{
    static struct mu_options o = {.program = "muster why",
                                  .usage = "[FILE] ROBOT [stalled@S | S | f-N@S]",
                                  .about =
                                      "Says of a recorded run why a robot stalled, drove as it "
                                      "did, or believed a fact.",
                                  MU_OPTION_TABLE(option_table)};
    mu_result parsed = mu_options_parse(&o, argc, argv);
    parsed = parsed == MU_OK ? words_take(&o, &ask) : parsed;
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    struct mu_fault fault;
    struct teller *t = mu_startup_alloc(sizeof *t);
    mu_result opened = teller_open(t, &fault);
    if (opened != MU_OK) {
        mu_fault_print(&fault);
        return mu_exit_for(opened);
    }
    if (t->robot == MU_NONE && t->mind == MINDS_NONE) { /* a clone has a mind, and no body */
        nobody_explain(t);
        return MU_EXIT_NO_AGENT;
    }
    mu_result answered = ask_answer(t);
    recording_close(&t->recording);
    return mu_exit_for(answered);
}
