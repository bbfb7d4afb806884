/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file consoles.h
 * The consoles of all pages: lines that people type go to agents, and what agents say comes back to
 * who has asked, or who watches.
 *
 * Until somebody acts no agent joins: a page that is only looked at changes nothing in a run.  Then
 * one agent, operator-N, speaks for all pages.
 */
#ifndef MUSTER_WEB_CONSOLES_H
#define MUSTER_WEB_CONSOLES_H

#include "desk/console_link.h"
#include "desk/forms.h"
#include "web/viewers.h"

enum {
    CONSOLES_MAX = 48,
    CONSOLES_ASKS_MAX = CONSOLE_PENDING_MAX,
    CONSOLES_TABS_MAX = 8,   /* words that wait to be completed, of an agent */
    CONSOLES_TAB_BYTES = 128 /* of a word with the character before it */
};

/* A line that waits for its end, and who has asked. */
struct console_ask {
    uint64_t line;   /* 0: free */
    uint64_t viewer; /* id */
    uint64_t number; /* the viewer's own */
};

/* A word that waits for the agent's words, to be completed out of them. */
struct console_tab {
    uint64_t viewer; /* 0: free */
    uint64_t number; /* the viewer's own */
    uint64_t since_ns;
    char word[CONSOLES_TAB_BYTES]; /* the end of the line */
};

struct console {
    bool used;
    char name[MU_NAME_MAX + 1]; /* of the agent */
    struct console_link link;
    struct console_ask asks[CONSOLES_ASKS_MAX];
    struct console_tab tabs[CONSOLES_TABS_MAX];
    uint64_t watchers[VIEWERS_MAX]; /* ids; 0: free */
    uint64_t used_ns;               /* when somebody did something with it last */
    struct consoles *all;
};

enum consoles_state { CONSOLES_OUT, CONSOLES_JOINING, CONSOLES_IN, CONSOLES_REFUSED };

struct consoles {
    mu_process *process;
    struct viewers *viewers;
    mu_agent *agent;
    enum consoles_state state;
    unsigned attempt; /* names that others hold */
    struct console all[CONSOLES_MAX];
    struct forms forms;
    struct mu_handlers handlers;
};

enum consoles_outcome {
    CONSOLES_DONE,
    CONSOLES_NOT_YET,   /* the agent joins just now; try again */
    CONSOLES_NO_BROKER, /* likewise, when there is one */
    CONSOLES_NO_NAME,   /* of an agent */
    CONSOLES_NO_FORM,   /* a parenthesis is open, or there is one too many */
    CONSOLES_MANY,      /* more lines at once than can ever wait */
    CONSOLES_BUSY,      /* too many lines wait, or too many consoles are open */
    CONSOLES_PARTLY,    /* the first of the lines went out; to be told, not to be tried again */
    CONSOLES_DENIED,    /* the broker gives us no name */
    CONSOLES_OUTCOMES
};

/** Takes the memory, at start-up. */
struct consoles *consoles_open(mu_process *process, struct viewers *viewers);

/**
 * Sends the forms of a text to an agent.  What it says comes to the viewer as events "said" and,
 * when nothing more comes, "ended", both with its number.
 */
enum consoles_outcome consoles_say(struct consoles *c, const char *agent, const char *text,
                                   uint64_t viewer, uint64_t number);

/**
 * Says how a line goes on: its last word is completed out of those that the agent knows.  It comes
 * to the viewer as an event "completed" with its number: rest, what belongs behind the line; and if
 * that is "", the words that it may become.
 *
 * @param line  up to the cursor
 */
enum consoles_outcome consoles_complete(struct consoles *c, const char *agent, const char *line,
                                        uint64_t viewer, uint64_t number);

/** Has a viewer shown, or no longer shown, what an agent's rules print and what is watched. */
enum consoles_outcome consoles_watch(struct consoles *c, const char *agent, uint64_t viewer,
                                     bool on);

/** After each spin of the process. */
void consoles_round(struct consoles *c);

/** @return the HTTP status that says it */
unsigned consoles_status(enum consoles_outcome outcome);

/** @return a line for people */
const char *consoles_text(enum consoles_outcome outcome);

#endif
