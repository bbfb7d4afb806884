/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file console_link.h
 * A console's side of the mail between it and the agent that it is for: lines that wait for their
 * answers, the answers' pieces, what is watched, the words that are completed.
 *
 * Knows no terminal and joins nobody: what is to be seen goes to show, and whoever has an agent in
 * whose name lines go out hands over what comes for it.  One agent may have several links.
 * docs/console.md has the directives.
 */
#ifndef MUSTER_DESK_CONSOLE_LINK_H
#define MUSTER_DESK_CONSOLE_LINK_H

#include "runtime/glances.h"

enum {
    CONSOLE_PENDING_MAX = 64,       /* lines that wait for their answers */
    CONSOLE_CREDIT = 16,            /* pieces of what is watched that may be under way */
    CONSOLE_WORDS_MAX = 128 * 1024, /* bytes of the words that are completed */
    CONSOLE_FORM_SHOWN = 48         /* bytes of a line that are shown with its failure */
};

enum console_kind {
    CONSOLE_ANSWER,  /* what a line printed */
    CONSOLE_FAILURE, /* the same of a line that failed */
    CONSOLE_TRACE,   /* what rules print, and what is watched */
    CONSOLE_NOTE     /* what the console says itself; a whole line */
};

struct console_pending {
    uint64_t seq;    /* of the mail */
    uint64_t glance; /* number of the question: it only looks; 0: it is a directive */
    uint64_t number; /* of the line */
    unsigned piece;  /* of the answer, that came last */
    char look[MU_GLANCE_LINE_MAX + 1]; /* the line of a glance */
};

struct console_link {
    mu_process *process;
    mu_agent *asker;   /* in whose name lines go out */
    const char *agent; /* whom it is for */
    /* Lines that wait, oldest first. */
    struct console_pending pending[CONSOLE_PENDING_MAX];
    size_t pending_count, pending_max;
    uint64_t lines;       /* sent so far */
    unsigned failures;    /* lines that failed */
    int code;             /* exit code of the last line that was not delivered, or MU_EXIT_DONE */
    uint64_t busy_number; /* of lines sent when it was last said that the agent is busy */
    uint64_t heard_ns;    /* when something came for a line last */
    bool attached;
    unsigned used;      /* pieces that came since room was given for more */
    uint64_t used_ns;   /* when the first of them came */
    uint32_t agent_pid; /* of the life that it is attached to */
    uint64_t spun_ns;   /* when it was there last, with a broker */
    char words[CONSOLE_WORDS_MAX];
    size_t words_len;
    uint64_t words_asked;    /* number of the question, or 0: none is under way */
    uint64_t words_asked_ns; /* when */
    bool words_stale;        /* a line may have changed them */
    void *self;              /* of show and ended */
    /* line: number of the line that it belongs to; 0: of none.  May be NULL. */
    void (*show)(void *self, enum console_kind kind, uint64_t line, const char *text);
    /* Nothing more comes for a line; good: it was done.  May be NULL. */
    void (*ended)(void *self, uint64_t line, bool good);
};

/**
 * Begins a link, to an agent that need not be there yet.
 *
 * @param l      zeroed, but for self, show and ended
 * @param agent  its name, which stays where it is
 */
void console_link_init(struct console_link *l, mu_process *process, mu_agent *asker,
                       const char *agent);

/** Takes a mail to the asker; one that is not for this link is passed over. */
void console_link_mail(struct console_link *l, const struct mu_mail *mail);

/** Takes what became of a glance of the asker, this link's or not: as glances_hear. */
void console_link_glance(struct console_link *l, uint64_t number, enum glance_end end,
                         const char *text);

/** Takes what became of mails of the asker, this link's or not. */
void console_link_receipt(struct console_link *l, uint64_t first_seq, uint64_t last_seq,
                          enum mu_outcome outcome);

/** After each spin of the process: attaches again and gives room where that is due. */
void console_link_round(struct console_link *l);

/** Asks for what rules print and what is watched. */
void console_link_attach(struct console_link *l);

/** Asks for no more of it.  @param seq  out: number of the mail.  @return MU_OK; MU_DONE: it was
 * not attached; others as mu_agent_send */
MU_MUST_USE mu_result console_link_detach(struct console_link *l, uint64_t *seq);

/**
 * Sends a line: one that only looks as a glance, if none is under way that may change what it sees.
 *
 * @param number  out: of the line, from 1 on; may be NULL
 * @return MU_OK; MU_FULL: as many as it can wait for are under way
 */
MU_MUST_USE mu_result console_link_line(struct console_link *l, const char *line, uint64_t *number);

/** Asks for the words anew. */
void console_link_ask_words(struct console_link *l);

/** Gives up the lines that wait. */
void console_link_forget(struct console_link *l);

/** @return the agent's state as the white pages have it */
enum mu_state console_link_state(const struct console_link *l);

#endif
