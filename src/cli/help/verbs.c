/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/help/help.h"

#include "core/exits.h"
#include "core/spell.h"
#include "core/text.h"

#include <stdio.h>
#include <string.h>

#define RUN       "Run experiments"
#define WATCH     "Watch a live run"
#define TALK      "Talk to agents"
#define AGENTS    "Agents and teams"
#define WORLD     "Worlds"
#define RECORD    "Recordings"
#define PROCESSES "Processes by hand, for deployments"
#define HELP      "Help"

const struct verb verbs[] = {
    {"new", RUN, "NAME", "an experiment and a rule file to change", "-"},
    {"run", RUN, "FILE", "run an experiment and leave a report", "experiment"},
    {"report", RUN, "DIR", "the report of a run again, from what lies in its folder", "folder"},
    {"compare", RUN, "DIR...", "several runs: means with intervals, table, plots", "folder..."},
    {"verify", RUN, "FILE", "do a recorded run again, and compare it step by step", "recording"},

    {"web", WATCH, "", "the live page of a run, in a browser on this machine", "recording"},
    {"top", WATCH, "", "what a run amounts to, live: a line for each robot and agent", ""},
    {"ps", WATCH, "", "the white pages: every agent and its state", ""},
    {"lookup", WATCH, "NAME", "one line of the white pages", "agent"},
    {"console", WATCH, "NAME", "look into an agent: CLIPS lines, answers, traces", "agent"},
    {"monitor", WATCH, "--rules FILE", "rules that look at a whole run", ""},
    {"wait", WATCH, "NAME...", "until agents, a service, a broker, hosts or a run are there",
     "agent..."},

    {"send", TALK, "TO WORD...", "mail to an agent", "target"},
    {"broadcast", TALK, "WORD...", "mail to every active agent", ""},
    {"do", TALK, "TARGETS 'LINE'", "a CLIPS line to agents", "target"},
    {"start", TALK, "TARGETS", "take agents out of standby", "target"},
    {"suspend", TALK, "TARGETS", "stop agents where they are", "target"},
    {"resume", TALK, "TARGETS", "let them go on", "target"},
    {"step", TALK, "TARGETS N", "let robots fire N rules", "target"},

    {"launch", AGENTS, "NAME HOST ...", "a new agent on a running host", "- host"},
    {"move", AGENTS, "NAME HOST", "an agent to another host", "agent host"},
    {"clone", AGENTS, "NAME NEW [HOST]", "a copy of an agent", "agent - host"},
    {"dispose", AGENTS, "TARGETS", "end agents for good", "target"},
    {"group", AGENTS, "list|join G|...", "groups: their members, join, leave, send",
     "list|members|create|join|leave|send group"},
    {"service", AGENTS, "list|find S|...", "the yellow pages: which agent offers what",
     "list|find|add|remove service"},

    {"world", WORLD, "check|place|...",
     "world files: check, draw, import; the world of a run: place, push, reset, ...",
     "check|draw|import|properties|place|push|reset|sensor|pace|save world"},

    {"record", RECORD, "[TOPIC...]", "topics into a file, until interrupted", ""},
    {"replay", RECORD, "FILE", "a recording on DDS again", "recording"},
    {"why", RECORD, "[FILE] ROBOT [...]", "why a recorded robot stalled, drove, believed",
     "recording"},

    {"broker", PROCESSES, "NAME", "one broker: names and mail", ""},
    {"sim", PROCESSES, "WORLD", "one simulator: bodies, senses, the clock of the run", "world"},
    {"robot", PROCESSES, "NAME --rules FILE", "one robot's controller", ""},
    {"agent", PROCESSES, "NAME --rules FILE", "one agent with rules and without a body", ""},
    {"host", PROCESSES, "NAME", "a platform that agents are launched on and move to", ""},
    {"resolver", PROCESSES, "SCHEME", "addresses such as role:scout or near:2.5", "near|role|task"},

    {"doctor", HELP, "", "what may keep muster from running on this machine, and the cure", ""},
    {"completion", HELP, "bash|zsh|fish", "completion of command lines, for a shell to source",
     "bash|zsh|fish"},
    {"topics", HELP, "", "the table of DDS topics, as Markdown", ""},
};

const size_t verbs_count = sizeof verbs / sizeof verbs[0];

bool verbs_have(const char *word)
{
    for (size_t i = 0; i < verbs_count; i++) {
        if (strcmp(word, verbs[i].name) == 0) {
            return true;
        }
    }
    return false;
}

int verbs_miss(const char *word)
{
    char shown[MU_TEXT_SHOWN];
    struct mu_spell meant;
    mu_spell_init(&meant, word);
    for (size_t i = 0; i < verbs_count; i++) {
        mu_spell_offer(&meant, verbs[i].name);
    }
    fprintf(stderr, "muster: there is no verb '%s'; ", mu_text_show(shown, word));
    if (meant.nearest) {
        fprintf(stderr, "did you mean '%s'? ", meant.nearest);
    }
    fputs("muster --help lists them\n", stderr);
    return MU_EXIT_USAGE;
}

void verbs_print(void)
{
    const char *group = "";
    fputs("Usage: muster VERB [...]\n\nA runtime for teams of robots and other agents on DDS.\n",
          stdout);
    for (size_t i = 0; i < verbs_count; i++) {
        if (strcmp(group, verbs[i].group) != 0) {
            group = verbs[i].group;
            printf("\n%s\n", group);
        }
        printf("  %-10s %-18s %s\n", verbs[i].name, verbs[i].usage, verbs[i].help);
    }
    fputs("\nmuster help VERB says more, muster help exits the exit codes.\n", stdout);
}

void verbs_dump(void)
{
    for (size_t i = 0; i < verbs_count; i++) {
        printf("%s\t%s\t%s\t%s\n", verbs[i].name, verbs[i].group, verbs[i].usage, verbs[i].help);
    }
}

void verbs_exits(void)
{
    const struct mu_exit_row *row;
    for (size_t i = 0; (row = mu_exit_at(i)); i++) {
        printf("%d\t%s\t%s\n", row->code, row->word, row->meaning);
    }
}
