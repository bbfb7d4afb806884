/* SPDX-License-Identifier: Apache-2.0 */
/* muster: the one command to learn.  Long-lived parts are programs of their own, git style. */
#include "bus/bus.h"
#include "cli/verbs.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/options.h"
#include "core/paths.h"
#include "core/spell.h"
#include "core/text.h"
#include "operator/operator.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct verb {
    const char *name;
    int (*run)(int argc, char **argv); /* NULL: the program below takes over */
    const char *program;
    const char *usage, *help;
};

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
                strcmp(*word, "--help") == 0;
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

static const struct verb verbs[] = {
    {"run", run_verb, NULL, "FILE", "run an experiment and leave a report"},
    {"report", report_verb, NULL, "DIR", "the report of a run again, from what lies in its folder"},
    {"compare", compare_verb, NULL, "DIR...", "several runs: means with intervals, table, plots"},
    {"broker", NULL, "muster-broker", "NAME", "one broker: names and mail"},
    {"sim", NULL, "muster-sim", "WORLD", "one simulator: bodies, senses, the clock of the run"},
    {"robot", NULL, "muster-robot", "NAME --rules FILE", "one robot's controller"},
    {"host", NULL, "muster-host", "NAME", "a platform that agents are launched on and move to"},
    {"resolver", NULL, "muster-resolver", "SCHEME", "addresses such as role:scout or near:2.5"},
    {"web", NULL, "muster-web", "", "the live page of a run, in a browser on this machine"},
    {"monitor", NULL, "muster-monitor", "--rules FILE", "rules that look at a whole run"},
    {"ps", pages_verb_ps, NULL, "", "the white pages: every agent and its state"},
    {"lookup", pages_verb_lookup, NULL, "NAME", "one line of the white pages"},
    {"wait", wait_verb, NULL, "NAME...",
     "until agents, a service, a broker, hosts or a run are there"},
    {"send", post_verb, NULL, "TO WORD...", "mail to an agent"},
    {"broadcast", post_verb, NULL, "WORD...", "mail to every active agent"},
    {"console", console_verb, NULL, "NAME", "look into an agent: CLIPS lines, answers, traces"},
    {"do", post_verb, NULL, "TARGETS 'LINE'", "a CLIPS line to agents"},
    {"start", post_verb, NULL, "TARGETS", "take agents out of standby"},
    {"suspend", post_verb, NULL, "TARGETS", "stop agents where they are"},
    {"resume", post_verb, NULL, "TARGETS", "let them go on"},
    {"step", post_verb, NULL, "TARGETS N", "let robots fire N rules"},
    {"launch", launch_verb, NULL, "NAME HOST ...", "a new agent on a running host"},
    {"move", post_verb, NULL, "NAME HOST", "an agent to another host"},
    {"clone", post_verb, NULL, "NAME NEW [HOST]", "a copy of an agent"},
    {"dispose", post_verb, NULL, "TARGETS", "end agents for good"},
    {"group", group_verb, NULL, "list|join G|...", "groups: who is in them, join, leave, send"},
    {"service", service_verb, NULL, "list|find S|...", "the yellow pages: who offers what"},
    {"world", world_verb, NULL, "check|place|...",
     "world files: check, draw, import; the world of a run: place, push, reset, ..."},
    {"top", top_verb, NULL, "", "what a run amounts to, live: a line for each robot"},
    {"record", record_verb, NULL, "[TOPIC...]", "topics into a file, until interrupted"},
    {"verify", verify_verb, NULL, "FILE", "do a recorded run again, and compare it step by step"},
    {"why", why_verb, NULL, "[FILE] ROBOT [...]", "why a recorded robot stalled, drove, believed"},
    {"replay", NULL, "muster-replay", "FILE", "a recording on DDS again"},
    {"topics", topics_verb, NULL, "", "the table of DDS topics, as Markdown"},
};

enum { VERBS = sizeof verbs / sizeof verbs[0] };

static void help_print(FILE *to)
{
    fputs("Usage: muster VERB [...]\n\nA runtime for teams of robots and other agents on DDS.\n\n",
          to);
    for (size_t i = 0; i < VERBS; i++) {
        fprintf(to, "  %-9s %-18s %s\n", verbs[i].name, verbs[i].usage, verbs[i].help);
    }
    fputs("\nmuster VERB --help says more.\n", to);
}

/* An answer that was not written is no answer.  @return the exit code */
static int output_end(int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) {
        return code;
    }
    fprintf(stderr, "muster: cannot write to standard output: %s\n", strerror(errno));
    return code == MU_EXIT_DONE ? MU_EXIT_WRITE : code;
}

static int verb_miss(const char *word)
{
    char shown[MU_TEXT_SHOWN];
    struct mu_spell meant;
    mu_spell_init(&meant, word);
    for (size_t i = 0; i < VERBS; i++) {
        mu_spell_offer(&meant, verbs[i].name);
    }
    fprintf(stderr, "muster: there is no verb '%s'; ", mu_text_show(shown, word));
    if (meant.nearest) {
        fprintf(stderr, "did you mean '%s'? ", meant.nearest);
    }
    fputs("muster --help lists them\n", stderr);
    return MU_EXIT_USAGE;
}

/* @param words  the verb and what follows */
static int verb_call(int count, char **words)
{
    for (size_t i = 0; i < VERBS; i++) {
        if (strcmp(words[0], verbs[i].name) == 0) {
            return verbs[i].run ? verbs[i].run(count, words)
                                : program_become(verbs[i].program, words);
        }
    }
    return verb_miss(words[0]);
}

static bool is_help(const char *word)
{
    return strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || strcmp(word, "help") == 0;
}

/* Without words, the command says what there is. */
static int live_print(void)
{
    int domain;
    if (runs_list(NULL, &domain) == 0) {
        fputs("No run of yours lives.  Try:\n"
              "  muster run follow      a run, and its report\n",
              stdout);
    } else {
        fputs("Runs of yours that live:\n", stdout);
        (void)runs_list(stdout, &domain);
        fputs("Try:\n"
              "  muster ps              who is there\n"
              "  muster top             what they do\n"
              "  muster web             the same in a browser\n",
              stdout);
    }
    fputs("  muster --help          all verbs\n", stdout);
    return MU_EXIT_DONE;
}

static int verb_run(int argc, char **argv)
{
    static char help[] = "--help";
    if (argc < 2) {
        return live_print();
    }
    if (is_help(argv[1]) && argc > 2) {
        return verb_call(2, (char *[]){argv[2], help, NULL});
    }
    if (is_help(argv[1])) {
        help_print(stdout);
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
