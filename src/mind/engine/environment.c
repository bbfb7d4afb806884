/* SPDX-License-Identifier: Apache-2.0 */
/* The environment of an engine: its functions that rules must not call, its output, its globals. */
#include "mind/engine/engine.h"

#include <stdio.h>
#include <string.h>

/*
 * Rules must not reach files, the shell, the process or the clock of the machine, nor remove the
 * functions of muster.
 */
static const char *const env_denied[] = {
    "exit",
    "system",
    "open",
    "close",
    "remove",
    "rename",
    "load",
    "load*",
    "save",
    "bload",
    "bsave",
    "batch",
    "batch*",
    "dribble-on",
    "dribble-off",
    "load-facts",
    "save-facts",
    "load-instances",
    "save-instances",
    "bload-instances",
    "bsave-instances",
    "restore-instances",
    "constructs-to-c",
    "fetch",
    "toss",
    "print-region",
    "get-region",
    "read",
    "readline",
    "read-number",
    "get-char",
    "set-locale",
    "release-mem",
    "conserve-mem",
    "clear",
    "profile",
    "profile-info",
    "profile-reset",
    "set-profile-percent-threshold",
    "get-profile-percent-threshold",
    "timer",
    "operating-system",
};

enum { ENVIRONMENT_PRINT_UNITS = 16 }; /* the cost of a printed word, beside one for each byte */

static const char *const env_kept_globals[2] = {"my-name", "mate"};

/* CLIPS asks this at each word that it prints, and at each byte of a file. */
static inline bool env_is(const char *name, const char *route)
{
    return name[0] == route[0] && name[1] == route[1] && strcmp(name, route) == 0;
}

static int env_route_query(void *env, const char *name)
{
    (void)env;
    static const char *const routes[] = {WDISPLAY, "stdout", "t",     WERROR, WWARNING,
                                         WTRACE,   WDIALOG,  "stdin", WPROMPT};
    for (size_t i = 0; i < sizeof routes / sizeof routes[0]; i++) {
        if (env_is(name, routes[i])) {
            return TRUE;
        }
    }
    return FALSE;
}

/* Prints while rules fire, within the limit of a step. */
static void env_print(struct mind *m, const char *text)
{
    size_t len = strlen(text);
    if (m->printed > ENVIRONMENT_PRINT_MAX || !m->options.ports.print) {
        return;
    }
    m->printed += len;
    if (m->printed > ENVIRONMENT_PRINT_MAX) {
        text = "\n[MUSTER3] more than 64 KiB printed in one step: the rest is left out\n";
    }
    m->options.ports.print(m->options.ports.self, text);
}

/* Leaves out the empty line before a complaint, which a console does not need. */
static void env_print_line(struct mu_text *out, bool complaint, const char *text)
{
    bool blank = out->len == 0 || out->at[out->len - 1] == '\n';
    if (!complaint || !blank || strcmp(text, "\n") != 0) {
        mu_text_add(out, text);
    }
}

static int env_route_print(void *env, const char *name, const char *text)
{
    struct mind *m = environment_mind(env);
    m->cost.units += ENVIRONMENT_PRINT_UNITS + strlen(text);
    bool complaint = env_is(name, WERROR) || env_is(name, WWARNING);
    if (complaint && m->stopped) {
        return TRUE; /* else each of a thousand nested calls says that it ends */
    }
    if (m->state == MIND_FIRING && env_is(name, WDIALOG)) {
        return TRUE; /* "Breaking on rule": the agent prints that itself */
    }
    const struct mind_ports *ports = &m->options.ports;
    bool watched = state_mode(m) != STATE_MODE_LINE && ports->trace && env_is(name, WTRACE);
    if (watched && ports->trace(ports->self, text)) {
        return TRUE;
    }
    if (state_mode(m) == STATE_MODE_LINE) {
        env_print_line(m->out, complaint, text);
    } else if (complaint || state_mode(m) == STATE_MODE_QUIET) {
        mu_text_add(&m->said, text);
    } else {
        env_print(m, text);
    }
    return TRUE;
}

static int env_route_getc(void *env, const char *name)
{
    (void)env;
    (void)name;
    return EOF;
}

static int env_route_ungetc(void *env, int c, const char *name)
{
    (void)env;
    (void)name;
    return c;
}

static int env_route_exit(void *env, int code)
{
    (void)code;
    AbortExit(env);
    SetHaltExecution(env, TRUE);
    return TRUE;
}

static struct {
    struct mind *mind;
    uint64_t entries;
} environment_last;

void environment_begin(struct mind *m)
{
    m->cost.meter = NULL;
    mu_text_clear(&m->said);
    SetHaltExecution(m->env, FALSE);
    SetEvaluationError(m->env, FALSE);
    environment_last.mind = m;
    environment_last.entries++;
}

struct mind *environment_entered(uint64_t *entries)
{
    *entries = environment_last.entries;
    return environment_last.mind;
}

bool environment_end(struct mind *m)
{
    bool failed = GetEvaluationError(m->env) || GetHaltExecution(m->env);
    SetHaltExecution(m->env, FALSE);
    SetEvaluationError(m->env, FALSE);
    return failed;
}

struct defmodule *environment_next_module(struct mind *m, struct defmodule *before)
{
    if (!before) {
        m->module = EnvGetCurrentModule(m->env);
    }
    struct defmodule *next = EnvGetNextDefmodule(m->env, before);
    EnvSetCurrentModule(m->env, next ? next : m->module);
    return next;
}

/* (reset) gives globals their first values: these two are kept over it. */
static void env_keep_globals(void *env)
{
    struct mind *m = environment_mind(env);
    for (size_t i = 0; i < 2; i++) {
        m->kept[i].type = RVOID;
        if (EnvGetDefglobalValue(env, env_kept_globals[i], &m->kept[i])) {
            ValueInstall(env, &m->kept[i]);
        }
    }
}

static void env_restore_globals(void *env)
{
    struct mind *m = environment_mind(env);
    for (size_t i = 0; i < 2; i++) {
        if (m->kept[i].type != RVOID) {
            EnvSetDefglobalValue(env, env_kept_globals[i], &m->kept[i]);
            ValueDeinstall(env, &m->kept[i]);
        }
    }
}

/* Lengths that rules may change, in mm. */
static const struct {
    const char *name;
    long long value_mm;
} env_globals[ENVIRONMENT_NUMBERS] = {
    [ENVIRONMENT_SONAR_MARGIN] = {"sonar-margin", 250},
    [ENVIRONMENT_SONAR_CLIP] = {"sonar-clip", 500},
    [ENVIRONMENT_FOLLOW_DISTANCE] = {"follow-distance", 1000},
    [ENVIRONMENT_CARE] = {"care", 1100},
};

double environment_global(const struct mind *m, enum environment_number which)
{
    const DATA_OBJECT *value = &m->globals[which]->current;
    bool number = value->type == FLOAT || value->type == INTEGER;
    return number ? value_of(value->type, value->value) : (double)env_globals[which].value_mm;
}

void environment_install(struct mind *m)
{
    for (size_t i = 0; i < sizeof env_denied / sizeof env_denied[0]; i++) {
        UndefineFunction(m->env, env_denied[i]);
    }
    EnvAddRouter(m->env, "mu-out", 40, env_route_query, env_route_print, env_route_getc,
                 env_route_ungetc, env_route_exit);
    /* between these two the globals are reset; afterwards, at 0, deffacts are asserted */
    EnvAddResetFunction(m->env, "mu-keep", env_keep_globals, 100);
    EnvAddResetFunction(m->env, "mu-restore", env_restore_globals, 25);
}

/* The robot's name is a valid symbol.  What C code keeps pointers to is in use: CLIPS does not let
 * it be removed. */
bool environment_build(struct mind *m)
{
    char bytes[512];
    struct mu_text globals = mu_text_in(bytes, sizeof bytes);
    mu_text_format(&globals, "(defglobal ?*my-name* = %s ?*mate* = nil", m->options.name);
    for (size_t i = 0; i < ENVIRONMENT_NUMBERS; i++) {
        mu_text_format(&globals, " ?*%s* = %lld", env_globals[i].name, env_globals[i].value_mm);
    }
    mu_text_add(&globals, ")");
    bool built = EnvBuild(m->env, globals.at);
    for (size_t i = 0; i < ENVIRONMENT_NUMBERS && built; i++) {
        m->globals[i] = EnvFindDefglobal(m->env, env_globals[i].name);
        m->globals[i]->busyCount++;
    }
    return built;
}

bool mind_enter(struct mind *m, enum state_event event)
{
    if (!state_on(m, event)) {
        return false;
    }
    m->stack = __builtin_frame_address(0);
    environment_begin(m);
    budget_start(m, state_spare(m));
    return true;
}

bool mind_leave(struct mind *m)
{
    m->stack = NULL;
    (void)state_on(m, STATE_DONE);
    return environment_end(m);
}
