/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file operator.h
 * A person's agent: what programs share at which people sit (consoles, answers, live runs), and the
 * command line as an agent: receivers of a mail, directives, changes of the pages.
 */
#ifndef MUSTER_OPERATOR_OPERATOR_H
#define MUSTER_OPERATOR_OPERATOR_H

#include "core/network.h"
#include "core/options.h"
#include "core/text.h"
#include "muster/agent.h"
#include "muster/directory.h"
#include "muster/limits.h"
#include "muster/result.h"
#include "runtime/probes.h"
#include "wire.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* --- answer.c --------------------------------------------------------------------------------- */

/* An answer to the command line's mail, as a person or a program wants it. */

/** @return whether it says that the mail was of no use: refuse, not-understood, failure */
bool answer_is_failure(const struct mu_mail *mail);

/** @return MU_EXIT_DONE; MU_EXIT_REFUSED: another agent has the name, the agent or its state does
 *          not allow it, or the trust policy; MU_EXIT_UNDELIVERED for any other failure */
int answer_exit(const struct mu_mail *mail);

/** Prints what an agent says; on a terminal "?" stands for what would steer it. */
void answer_text_print(FILE *to, const char *text);

/** Prints likewise what an answer says, as a line; content that is a single CLIPS string without
 * quotes. */
void answer_content_print(FILE *to, const char *content);

/** Prints it on standard output, or, if it is a refusal, why on standard error. */
void answer_print(const struct mu_mail *mail, bool json);

/** @return the exit code for what became of a mail */
int answer_outcome_exit(enum mu_outcome outcome);

/** @return what follows the outcome's word in a message to a person; "": nothing.  @param to the
 * receiver of the mail */
const char *answer_outcome_advice(enum mu_outcome outcome, const char *to);

/** @return what is meant by the code in why an agent stays, such as `red unknown-host`; NULL:
 *          that says enough */
const char *answer_travel_advice(const char *content);

/* --- complete.c ------------------------------------------------------------------------------- */

/* What a half-typed word of a line may become.  Pure. */

enum { COMPLETE_REST = 128, COMPLETE_LISTED_MAX = 200 };

/* The word before the cursor. */
struct complete_word {
    const char *at;
    size_t len;
    bool begins; /* it stands behind an open parenthesis: a function or a relation */
};

/* One that it may become. */
struct complete_match {
    const char *at; /* in the words */
    size_t len;
};

/** Finds the word before the cursor in a line of len bytes. */
struct complete_word complete_word(const char *line, size_t len);

/**
 * Finds the next word that begins as w does, each once: two kinds may share a name.
 *
 * @param words  lines "KIND NAME", as a robot lists them; see docs/console.md
 * @param from   where to look; moved on
 * @return false: there is none
 */
bool complete_next(const char *words, const char **from, struct complete_word w,
                   struct complete_match *match);

/** @return how many bytes behind w all matches share; *count: how many there are */
size_t complete_common(const char *words, struct complete_word w, size_t *count,
                       struct complete_match *first);

/**
 * Says how the line is to go on behind w: with what all matches share, and a space when there is
 * one match alone.
 *
 * @param rest  out: ""; there is none, or several that differ from here on
 * @return how many matches there are
 */
size_t complete_rest(const char *words, struct complete_word w, char rest[COMPLETE_REST]);

/* --- console_link.c --------------------------------------------------------------------------- */

/*
 * A console's side of the mail between it and the agent that it is for: lines that wait for their
 * answers, the answers' pieces, what is watched, the words that are completed.
 *
 * Knows no terminal and joins no broker: what is to be seen goes to show, and the owner of the
 * agent that sends the lines hands over what comes for it.  One agent may have several links.
 * docs/console.md has the directives.
 */

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
    const char *agent; /* the receiver */
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

/** Takes what became of a glance of the asker, this link's or not: as probes_hear. */
void console_link_glance(struct console_link *l, uint64_t number, enum probe_end end,
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

/* --- forms.c ---------------------------------------------------------------------------------- */

/*
 * Finds the forms in lines that a person types or pastes: an open parenthesis goes on in the next
 * line.
 *
 * A form is what stands between a parenthesis and the one that closes it, a string, or a word.
 * Comments between forms are passed over.  Pure.
 */

enum forms_found {
    FORMS_MORE,  /* the text is over, and perhaps a form is open */
    FORMS_READY, /* text has a form */
    FORMS_LONG,  /* one was longer than MU_CONTENT_MAX, and is left out; text has its beginning */
    FORMS_EXTRA  /* a parenthesis is closed that was not open; it is left out */
};

struct forms {
    char text[MU_CONTENT_MAX + 1]; /* of the form, zero-terminated when it is ready */
    size_t len;                    /* bytes of the form so far, also of what did not fit */
    unsigned depth;                /* of open parentheses */
    bool string, escaped, comment; /* inside of one; behind a backslash */
    bool done;                     /* text was handed out */
};

void forms_clear(struct forms *f);

/**
 * Goes on to the end of the next form.
 *
 * @param at  the text that comes next, zero-terminated, a line's end in it; moved on
 */
enum forms_found forms_next(struct forms *f, const char **at);

/** @return whether a form is begun and not ended */
bool forms_are_open(const struct forms *f);

/* --- reader.c --------------------------------------------------------------------------------- */

/*
 * Names of programs that join as a further operator: operator-N.
 *
 * There are few of them, as a broker keeps each that it has ever heard.
 */

/**
 * Makes a name; one that is held by another is no reason to give up before the next.
 *
 * @param attempt  0, 1, ...: another name each
 * @param stays    it reads for long: a brief reader does not take its name while it is away */
void reader_name(char name[MU_NAME_MAX + 1], unsigned attempt, bool stays);

/** @return whether that is a verb that only reads, another program's or our own */
bool reader_is(const struct mu_member *m);

/* --- runs.c ----------------------------------------------------------------------------------- */

/*
 * The runs of this user that live now, each in a DDS domain of its own.
 *
 * A run holds a lock on a small file in $XDG_RUNTIME_DIR/muster, or in /tmp/muster-UID when
 * that names no folder; a lock ends
 * with its process, so a file without a lock is no run.
 */

/** Domains that a run picks from: below them is the common 0, above are ephemeral ports. */
enum { RUNS_DOMAIN_FIRST = 1, RUNS_DOMAIN_LAST = 99 };

enum { RUNS_NAME_MAX = 127 };

/**
 * Takes a domain for the life of this process.
 *
 * @param wanted  the domain, or -1 to pick a free one
 * @param name    of the experiment, for lists of runs
 * @param domain  out
 * @return MU_OK; MU_EXISTS: another run has it; MU_BUSY: other programs have its DDS ports;
 *         of -1, either: there is none left; MU_FAULT_OS: there is no folder for the list, which is
 *         explained on standard error
 */
MU_MUST_USE mu_result runs_take(int wanted, const char *name, int *domain);

/**
 * Finds the one live run of this user.
 *
 * @param domain  out: its domain, or 0 when there is none
 * @return MU_OK; MU_EXISTS: several, which are named on standard error
 */
MU_MUST_USE mu_result runs_find(int *domain);

/** Notes where the report of this process's run is, and that it lives now: again at its end. */
void runs_note(const char *name, const char *folder);

/** @return whether the run in a domain, or the last one there, has noted its report's folder */
bool runs_folder_of(int domain, char *folder, size_t size);

/** Says on standard error which runs of this user live, else that one has just ended, or how to
 * start one.  @param domain  where it was; -1: anywhere */
void runs_tell_last(const char *program, int domain);

/**
 * Finds the next live run of this user.
 *
 * @param domain  where to look from; out: the run's
 * @param name    out: the experiment's
 * @return false: there is none
 */
bool runs_next(int *domain, char name[RUNS_NAME_MAX + 1]);

/**
 * Lists the live runs of this user, a line each.
 *
 * @param to      NULL: nothing is printed
 * @param domain  out: that of the last one
 * @return how many there are
 */
unsigned runs_list(FILE *to, int *domain);

/* --- world_words.c ---------------------------------------------------------------------------- */

/* What people do to the world of a run that lives, in words: place red 1 2 90.  Pure. */

enum { WORLD_WORDS_WRONG = 256 };

/** @return whether that is a verb of it */
bool world_words_know(const char *verb);

/**
 * Reads an order: a verb, and what belongs to it.
 *
 * @param push_s  that a push lasts, in simulated seconds; 0: it is an impulse
 * @param c       out: order and what it is about; its texts point into the words.  Simulator,
 *                source, number and times are the caller's
 * @param wrong   out: what was expected, as a line without its end
 * @return MU_OK; MU_FAULT_USAGE
 */
MU_MUST_USE mu_result world_words_read(const char *const *words, size_t count, double push_s,
                                       muster_RunCommand *c, char wrong[WORLD_WORDS_WRONG]);

/* --- words.c ---------------------------------------------------------------------------------- */

/* Words of the command line: joined, checked, shown. */

/** Joins words with spaces.  @return whether they fitted */
bool words_join(char *text, size_t size, const char *const *words, size_t count);

/** @return whether all of it is UTF-8 */
bool words_are_utf8(const char *text);

/** @return whether it is a name; if not, standard error says what one is */
bool words_name_check(const char *program, const char *what, const char *name);

/** The same for that of an agent that is made, or of a host. */
bool words_place_check(const char *program, const char *name);

/** The same for a group. */
bool words_group_check(const char *program, const char *name);

/** The same for a query of the yellow pages. */
bool words_query_check(const char *program, const char *query);

/* --- receivers.c ------------------------------------------------------------------------------ */

/* TO and TARGETS of the command line: the receivers of a mail. */

/* What a person is told whose receivers are not valid. */
#define RECEIVERS_EXPECTED \
    "a name, names joined by commas, all, robots, special, group:G or SCHEME:REST"

/** @return whether no agent in particular is meant, so that none in particular has to answer */
bool receivers_are_many(const char *to);

/** @return whether there is a group of that name */
bool receivers_are_group(const mu_process *p, const char *name);

/** @return whether all, robots, special or group:G means that agent */
bool receivers_have(const mu_process *p, const char *to, const struct mu_member *m);

/**
 * Counts the agents whose answer may be waited for: with names, each of them; else all that are
 * there now.
 *
 * @param from         the sender, which gets no mail of its own
 * @param robots_only  only robots know how to answer
 */
unsigned receivers_count(const mu_process *p, const char *to, const char *from, bool robots_only);

/* --- operator.c ------------------------------------------------------------------------------- */

/*
 * The command line as an agent: it joins as `operator`, does one thing and leaves.
 *
 * A verb that only reads joins as `operator-N`, so that many of them can look at a time; there are
 * few such names, as a broker keeps each that it has ever heard.
 */

/* What a verb that lives longer does with what comes, in place of the operator. */
struct operator_hooks {
    void *self;
    void (*on_mail)(void *self, const struct mu_mail *mail);
    void (*on_receipt)(void *self, uint64_t first_seq, uint64_t last_seq, enum mu_outcome outcome);
};

struct operator_options {
    struct mu_network network; /* domain < 0: the one live run's, else 0 */
    const char *as;            /* NULL: operator, or a reader's name */
    double wait_s;             /* for an answer; 0: none is wanted */
    bool json, quiet;
    bool takes_no_mail; /* what waits for the agent stays where it is */
    bool only_reads;    /* it need not be the operator; a console is the operator all the same */
    bool stays;         /* it reads for long: a brief reader does not take its name while
                           it is away */
    const struct operator_hooks *hooks; /* or NULL */
};

struct operator
{
    mu_process *process;
    mu_agent *agent;
    bool registered, refused;
    char reason[MU_FIELD_MAX + 1]; /* refused: why */
    bool json, quiet;
    enum mu_outcome outcome; /* of the last mail sent: the last word so far */
    uint64_t seq;            /* its number */
    bool answered_for;       /* there is an outcome */
    bool asks_many;          /* no agent in particular: not-understood is no answer */
    unsigned answers;        /* mails that came in reply to it */
    int failure_code;        /* the smallest exit code of those that are failures; 0: none is */
    const char *reply_with;  /* that answers refer to; NULL: none are wanted */
    char reply_with_own[32];
    uint64_t glance;       /* number of the question that was asked; 0: none waits */
    enum probe_end looked; /* what came of it */
    const struct operator_hooks *hooks;
    /* Takes an answer instead of its being printed; may be NULL. */
    void (*on_answer)(void *self, const struct mu_mail *mail);
    void *on_answer_self;
};

/* Rows of an options table that every such verb has. */
#define OPERATOR_OPTIONS(options)       \
    MU_JOIN_OPTIONS((options).network), \
        MU_STRING("as", "NAME", (options).as, "act as another agent than the operator")

/** Reads the options of a verb; its words stay in o.  @return MU_OK, MU_DONE or a fault */
MU_MUST_USE mu_result operator_parse(struct mu_options *o, int argc, char **argv,
                                     struct operator_options *options);

/**
 * Joins and waits for the broker's word and all of its pages.  A name that another verb holds is
 * waited for.
 *
 * @return MU_EXIT_DONE, or the exit code, explained
 */
int operator_join(struct operator* o, const struct operator_options *options, const char *verb);

/**
 * Sends one mail, waits for its receipt and, if answers_wanted > 0, for so many answers, which are
 * printed on standard output, unless on_answer takes them.
 *
 * @param mail  reply_with: "" or NULL: one is made up if answers are wanted
 * @return the exit code
 */
int operator_send(struct operator* o, struct mu_mail *mail, unsigned answers_wanted, double wait_s);

/**
 * Asks one agent for a line that only looks, and prints the answer as that of a directive.
 *
 * @return the exit code; < 0: it is no such line, or was declined, and nothing was printed
 */
int operator_look(struct operator* o, const char *agent, const char *line, double wait_s);

/** @return the line of an agent that was addressed by name, and is busy; NULL: that is not why */
const struct mu_member *operator_busy(const struct operator* o, const char *to);

/** Prints what became of a mail as an object.  @param code  exit code; < 0: it is left out */
void operator_outcome_print(const char *to, uint64_t seq, const char *outcome, int code);

void operator_leave(struct operator* o);

/* --- change.c --------------------------------------------------------------------------------- */

/* Changes of groups and services from the command line, in the operator's name or another's. */

struct change {
    const char *program;      /* "muster group join" */
    const char *performative; /* of the mail to the broker */
    const char *content;      /* without the agent */
    bool of_nobody;           /* it concerns no agent */
};

/** Adds what `advertise` says of a service: its name, its attributes, its lease. */
void change_add_offer(struct mu_text *t, const char *service, const char *attributes,
                      double lease_s);

/** @return whether that can be an agent's name in which a change is made; said if not */
bool change_name_check(const char *program, const char *as);

/**
 * Makes a change in the name of options->as and leaves the operator joined.
 *
 * The operator says it to the broker, which asks the trust policy; an agent that is not known yet
 * joins for the moment, so that its name is known.
 *
 * @return the exit code, explained
 */
int change_make(struct operator* op, const struct operator_options *options,
                const struct change *c);

/* --- envelope.c ------------------------------------------------------------------------------- */

/* The options of a mail from the command line: its performative, its level, how long it lives. */

/* As typed; NULL: not said. */
struct envelope {
    const char *performative, *language, *ontology, *conversation, *reply_with;
    const char *level, *priority;
    double ttl_s, reply_by_s; /* 0: not said */
    int64_t layer;
};

enum { ENVELOPE_ROWS = 10 };

/* Rows of an options table, ENVELOPE_ROWS of them. */
#define ENVELOPE_OPTIONS(e)                                                                        \
    MU_STRING("performative", "P", (e).performative, "the speech act, for example ask-one"),       \
        MU_STRING("level", "L", (e).level,                                                         \
                  "what it survives while it waits: ram (nothing), logged (the broker's "          \
                  "death), synced (the loss of power)"),                                           \
        MU_STRING("priority", "P", (e).priority, "low, normal or high: high overtakes"),           \
        MU_REAL("ttl", "S", (e).ttl_s, "it expires when it has waited so long", .max = 1e9),       \
        MU_STRING("language", "L", (e).language, "of the content; clips unless said"),             \
        MU_STRING("ontology", "O", (e).ontology, "what the words of the content mean"),            \
        MU_STRING("conversation", "C", (e).conversation, "that it belongs to"),                    \
        MU_STRING("reply-with", "R", (e).reply_with, "what an answer is to refer to"),             \
        MU_REAL("reply-by", "S", (e).reply_by_s, "no answer is wanted after this time of the run", \
                .max = 1e9),                                                                       \
        MU_INTEGER(                                                                                \
            "layer", "N", (e).layer,                                                               \
            "of the receiver's chain that takes it: 1 system, 2 queries, 3 speech acts, or "       \
            "one of its own",                                                                      \
            .fallback = "3", .min = 1, .max = UINT32_MAX)

/** Checks what was typed and puts it into a mail.  @return false: said on standard error */
bool envelope_fill(const struct envelope *e, struct mu_mail *mail, const char *verb);

/* --- direct.c --------------------------------------------------------------------------------- */

/*
 * A directive to one agent or many, each of which gets a mail of its own and has a line of its own:
 * its answer, a refusal, or its silence.
 */

struct direct {
    const char *to, *performative, *content;
    double wait_s; /* for answers */
    bool may_wait; /* an agent that is away does it when it is back: that counts as done */
};

/** Lets the operator hand over what comes; before it joins. */
void direct_hear(struct operator_options *options);

/** @return whether the command line can say which agents are meant: no resolver is asked */
bool direct_is_possible(const char *to);

/**
 * Sends it to each and waits for what becomes of it; of several receivers, counts are the last
 * object with --json.
 *
 * @return MU_EXIT_DONE if all did it, else the smallest exit code of a receiver
 */
int direct_send(struct operator* o, const struct direct *d);

/* --- launch_text.c ---------------------------------------------------------------------------- */

/*
 * What a host is sent of an agent that is launched there: a passport, a line for each global and
 * group, and the rules.  It goes in pieces, as directives `launch`.
 */

enum { LAUNCH_RULES_MAX = 512 * 1024, LAUNCH_HEAD_MAX = 8 * 1024 };

/** Begins the text, in memory that lives as long as the process.  @param start  it runs at once */
struct mu_text *launch_text_begin(const char *name, bool start, int64_t seed);

/** Adds the rules of a file, and of those that it extends and that lie beside it.  @return MU_OK;
 * MU_FAULT_FILE: what is wrong is said */
MU_MUST_USE mu_result launch_text_rules(struct mu_text *out, const char *file);

#endif
