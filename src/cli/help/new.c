/* SPDX-License-Identifier: Apache-2.0 */
/* muster new: an experiment and a rule file to change. */
#include "cli/help/help.h"
#include "core/exits.h"
#include "core/json.h"
#include "core/name.h"
#include "core/options.h"
#include "core/paths.h"
#include "core/text.h"
#include "muster/limits.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* @NAME@ and @WORLD@ are filled in. */
static const char experiment_text[] =
    "# An experiment to change.  It runs as it is:\n"
    "#\n"
    "#   muster run @NAME@.yaml\n"
    "#\n"
    "# Times are seconds of simulated time, lengths metres, angles degrees.  Paths start at this\n"
    "# file.\n"
    "\n"
    "name: @NAME@\n"
    "world: '@WORLD@'\n"
    "duration: 60\n"
    "\n"
    "# Each robot is a process of its own with a CLIPS mind.  The world has places for red, blue,\n"
    "# green and yellow: a second robot is one more line.\n"
    "robots:\n"
    "  - {name: red, rules: @NAME@.clp}\n"
    "# - {name: blue, rules: @NAME@.clp}\n"
    "\n"
    "# What is said to robots when: lines of CLIPS, as on a robot's console.\n"
    "observer:\n"
    "  - {at: 0, do: red, line: \"(patrol)\"}\n"
    "\n"
    "# What must come true; if it does not, muster run ends with exit code 1.\n"
    "expect:\n"
    "  - {inside: arena}\n";

static const char rules_text[] =
    "; Rules to change: a robot that drives straight on and turns away from what is near.\n"
    "; muster.clp, which every robot has, adds (wander), (follow NAME), (goto X Y) and more.\n"
    ";\n"
    "; Lengths are millimetres, speeds mm/s and degrees/s.\n"
    "\n"
    "(defglobal\n"
    "  ?*speed* = 300\n"
    "  ?*turn*  = 60\n"
    "  ?*near*  = 700)\n"
    "\n"
    "; What the robot wants when it starts.\n"
    "(deffacts beginning\n"
    "  (goal stay))\n"
    "\n"
    "; The experiment says (patrol) to red.\n"
    "(deffunction patrol ()\n"
    "  (new-goal patrol))\n"
    "\n"
    "; Each step brings a new position fact and so fires one of these rules.\n"
    "(defrule straight-on\n"
    "  (goal patrol)\n"
    "  (position $?)\n"
    "  =>\n"
    "  (setSpeed ?*speed* 0)\n"
    "  (update-sensors))\n"
    "\n"
    "; s3 and s4 look ahead.  This rule is more urgent than straight-on: its salience is higher.\n"
    "(defrule turn-away\n"
    "  (declare (salience 5))\n"
    "  (goal patrol)\n"
    "  (position $?)\n"
    "  (sonar ? ? ? ? ?s3 ?s4 $?)\n"
    "  (test (< (min ?s3 ?s4) ?*near*))\n"
    "  =>\n"
    "  (setSpeed 0 ?*turn*)\n"
    "  (update-sensors))\n";

enum { FILES = 2, PATH_ROOM = MU_NAME_MAX + 8 };

struct new_files {
    char path[FILES][PATH_ROOM]; /* experiment, rules */
    char world[PATH_MAX];
};

static bool json;
static struct mu_option option_table[] = {MU_FLAG("json", json, "one object a line")};

static int name_check(const char *name)
{
    const char *ending = strrchr(name, '.');
    if (!mu_name_valid(name)) {
        char shown[MU_TEXT_SHOWN];
        fprintf(stderr,
                "muster new: '%s' is no name: it must match [A-Za-z_][A-Za-z0-9_.-]{0,30}; the "
                "files are made in the current folder\n",
                mu_text_show(shown, name));
        return MU_EXIT_USAGE;
    }
    if (ending && (strcmp(ending, ".yaml") == 0 || strcmp(ending, ".clp") == 0)) {
        fprintf(stderr, "muster new: give the name alone: muster new %.*s\n", (int)(ending - name),
                name);
        return MU_EXIT_USAGE;
    }
    return MU_EXIT_DONE;
}

static bool world_find(char world[PATH_MAX])
{
    char folder[PATH_MAX], path[PATH_MAX];
    return mu_path_own(folder, sizeof folder, "worlds", "arena.world") &&
           mu_path_join(path, sizeof path, folder, "arena.world") && realpath(path, world);
}

/* A quote in YAML's single quotes stands twice. */
static void world_put(FILE *to, const char *world)
{
    for (; *world; world++) {
        fprintf(to, *world == '\'' ? "%c'" : "%c", *world);
    }
}

static void text_put(FILE *to, const char *text, const char *name, const char *world)
{
    for (const char *mark; (mark = strchr(text, '@')) != NULL; text = strchr(mark + 1, '@') + 1) {
        fprintf(to, "%.*s", (int)(mark - text), text);
        if (mark[1] == 'N') {
            fputs(name, to);
        } else {
            world_put(to, world);
        }
    }
    fputs(text, to);
}

/* Writes a file that is not there yet.  @return whether it is whole; errno says why not */
static bool file_make(const char *path, const char *text, const char *name, const char *world)
{
    FILE *to = fopen(path, "wxe");
    if (!to) {
        return false;
    }
    text_put(to, text, name, world);
    bool whole = !ferror(to);
    int fault = errno;
    whole = fclose(to) == 0 && whole;
    if (!whole) {
        fault = errno ? errno : fault;
        unlink(path);
        errno = fault;
    }
    return whole;
}

static int file_fault(const char *path)
{
    if (errno == EEXIST) {
        fprintf(stderr, "muster new: %s is there already, and stays as it is\n", path);
    } else {
        fprintf(stderr, "muster new: cannot write %s: %s\n", path, strerror(errno));
    }
    return MU_EXIT_WRITE;
}

static int files_make(const struct new_files *f, const char *name)
{
    static const char *const texts[FILES] = {experiment_text, rules_text};
    for (int i = 0; i < FILES; i++) {
        if (!file_make(f->path[i], texts[i], name, f->world)) {
            int code = file_fault(f->path[i]);
            while (--i >= 0) {
                unlink(f->path[i]); /* all or nothing */
            }
            return code;
        }
    }
    return MU_EXIT_DONE;
}

static void files_tell(const struct new_files *f)
{
    if (json) {
        struct mu_json j = mu_json_line(stdout);
        mu_json_string(&j, "experiment", f->path[0]);
        mu_json_string(&j, "rules", f->path[1]);
        mu_json_string(&j, "world", f->world);
        mu_json_end(&j);
        return;
    }
    printf("%s  the experiment: robots, what is said to them, what is expected\n"
           "%s   the rules of its robot\n"
           "Try:\n"
           "  muster run %s --watch\n",
           f->path[0], f->path[1], f->path[0]);
}

int new_verb(int argc, char **argv)
{
    static struct mu_options o = {
        .program = "muster new",
        .usage = "NAME [OPTION...]",
        .about = "Makes NAME.yaml and NAME.clp in the current folder: an experiment that runs at "
                 "once, and the rules of its robot, to change.  What is there already stays.",
        MU_OPTION_TABLE(option_table)};
    static struct new_files f;
    mu_result parsed = mu_options_parse(&o, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    if (o.words_count != 1) {
        fputs("muster new: give it one name, for example: muster new mine\n", stderr);
        return MU_EXIT_USAGE;
    }
    int code = name_check(o.words[0]);
    if (code != MU_EXIT_DONE) {
        return code;
    }
    if (!world_find(f.world)) {
        fputs("muster new: muster's own worlds are not found; make install puts them in place\n",
              stderr);
        return MU_EXIT_FILE;
    }
    snprintf(f.path[0], PATH_ROOM, "%s.yaml", o.words[0]);
    snprintf(f.path[1], PATH_ROOM, "%s.clp", o.words[0]);
    code = files_make(&f, o.words[0]);
    if (code == MU_EXIT_DONE) {
        files_tell(&f);
    }
    return code;
}
