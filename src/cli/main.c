/* SPDX-License-Identifier: Apache-2.0 */
/* muster: the one command to learn.  Long-lived parts are programs of their own, git style. */
#include "bus/bus.h"
#include "cli/help/help.h"
#include "cli/verbs.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/options.h"
#include "core/paths.h"
#include "muster/version.h"
#include "operator/operator.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int program_become(const char *program, char **argv)
{
    char path[PATH_MAX];
    if (mu_path_program(path, sizeof path, program)) {
        execv(path, argv);
    }
    fprintf(stderr, "muster: cannot start %s: %s\n", program, strerror(errno));
    return MU_EXIT_CRASH;
}

/* A program that names no domain means the one run of this user that lives.
 * @return false: there are several, which are named */
static bool run_find(char **argv)
{
    char number[16];
    int domain = 0;
    bool named = getenv("MUSTER_DOMAIN") != NULL;
    for (char **word = argv; *word; word++) {
        named = named || strncmp(*word, "--domain", strlen("--domain")) == 0 ||
                strcmp(*word, "--help") == 0 || strcmp(*word, "--dump-options") == 0;
    }
    if (!named && runs_find(&domain) != MU_OK) {
        return false;
    }
    snprintf(number, sizeof number, "%d", domain);
    return named || setenv("MUSTER_LIVE_DOMAIN", number, 1) == 0;
}

static int record_verb(int argc, char **argv)
{
    (void)argc;
    return run_find(argv) ? program_become("muster-record", argv) : MU_EXIT_SEVERAL;
}

static int topics_verb(int argc, char **argv)
{
    static struct mu_options o = {.program = "muster topics",
                                  .usage = "[OPTION...]",
                                  .about = "Prints the table of DDS topics, as Markdown.",
                                  .no_words = true};
    mu_result parsed = mu_options_parse(&o, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    bus_print_topics();
    return MU_EXIT_DONE;
}

/* A verb that is not here is a program of its own. */
static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
} calls[] = {
    {"new", new_verb},         {"run", run_verb},
    {"report", report_verb},   {"compare", compare_verb},
    {"verify", verify_verb},   {"top", top_verb},
    {"ps", pages_verb_ps},     {"lookup", pages_verb_lookup},
    {"console", console_verb}, {"wait", wait_verb},
    {"send", post_verb},       {"broadcast", post_verb},
    {"do", post_verb},         {"start", post_verb},
    {"suspend", post_verb},    {"resume", post_verb},
    {"step", post_verb},       {"launch", launch_verb},
    {"move", post_verb},       {"clone", post_verb},
    {"dispose", post_verb},    {"group", group_verb},
    {"service", service_verb}, {"world", world_verb},
    {"record", record_verb},   {"why", why_verb},
    {"doctor", doctor_verb},   {"completion", completion_verb},
    {"topics", topics_verb},
};

/* An answer that was not written is no answer.  @return the exit code */
static int output_end(int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) {
        return code;
    }
    fprintf(stderr, "muster: cannot write to standard output: %s\n", strerror(errno));
    return code == MU_EXIT_DONE ? MU_EXIT_WRITE : code;
}

/* With --json errors are objects: of a verb that goes on for long, behind what it says meanwhile.
 */
static int call_run(size_t which, int count, char **words)
{
    static const char *const long_ones[] = {"run", "top", "wait", "verify", "console"};
    bool is_json = errors_are_json(count, words), is_long = false;
    for (size_t i = 0; i < sizeof long_ones / sizeof long_ones[0]; i++) {
        is_long = is_long || strcmp(words[0], long_ones[i]) == 0;
    }
    int code = MU_EXIT_CRASH;
    if (is_json && !is_long && !errors_catch(&code)) {
        return code;
    }
    code = calls[which].run(count, words);
    if (is_json && is_long && code != MU_EXIT_DONE) {
        errors_print(code, "");
    }
    return code;
}

/* @param words  the verb and what follows */
static int verb_call(int count, char **words)
{
    char program[64];
    if (!verbs_have(words[0])) {
        return verbs_miss(words[0]);
    }
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        if (strcmp(words[0], calls[i].name) == 0) {
            return call_run(i, count, words);
        }
    }
    snprintf(program, sizeof program, "muster-%s", words[0]);
    return program_become(program, words);
}

static bool is_help(const char *word)
{
    return strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || strcmp(word, "help") == 0;
}

static int verb_run(int argc, char **argv)
{
    static char help[] = "--help";
    if (argc < 2) {
        return live_print();
    }
    if (is_help(argv[1]) && argc > 2 && strcmp(argv[2], "exits") == 0) {
        verbs_exits();
        return MU_EXIT_DONE;
    }
    if (is_help(argv[1]) && argc > 2) {
        return verb_call(2, (char *[]){argv[2], help, NULL});
    }
    if (is_help(argv[1])) {
        verbs_print();
        return MU_EXIT_DONE;
    }
    if (strcmp(argv[1], "--dump-verbs") == 0) {
        verbs_dump();
        return MU_EXIT_DONE;
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("muster %s\n", MU_VERSION);
        return MU_EXIT_DONE;
    }
    return verb_call(argc - 1, argv + 1);
}

int main(int argc, char **argv)
{
    mu_log_open("muster", MU_LOG_WARNING);
    return output_end(verb_run(argc, argv));
}
