/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mind.h
 * A robot's mind: one CLIPS environment, its percepts, its mail and its rules.
 *
 * CLIPS stays behind this header; so do its units: here everything is SI, inside the rules it is
 * the paper's millimetres and degrees.  Nothing here knows DDS or reads a clock.  One thread.
 */
#ifndef MUSTER_AGENT_MIND_H
#define MUSTER_AGENT_MIND_H

#include "core/fault.h"
#include "core/text.h"
#include "mind/interface/interface.h"

struct mind;

/** Makes an environment with the sandbox, the functions and the shared library in it. */
MU_MUST_USE mu_result mind_open(struct mind **out, const struct mind_options *options,
                                struct mu_fault *fault);

/** Takes the memory of a mind while the process starts, for a mind_begin at any time. */
struct mind *mind_reserve(void);

/** As mind_open, in memory that was reserved and holds no mind, or one that was closed. */
MU_MUST_USE mu_result mind_begin(struct mind *m, const struct mind_options *options,
                                 struct mu_fault *fault);

/** Its memory stays. */
void mind_close(struct mind *m);

/** @return whether it ran out of memory or time where there is no way back: nothing works any more
 */
bool mind_is_broken(const struct mind *m);

/**
 * Looks whether the engine of some mind hangs; then its port stuck says what is to become of it.
 * A timer of the owner calls it every ms of the processor's time of the thread that has the minds,
 * in a signal handler, out of which the way may lead to where that mind was called.
 *
 * @return MIND_WAITS, or the exit code with which the process is to end; *why says why
 */
int mind_look(unsigned ms, struct mu_text *why);

/**
 * Writes a mind down as a snapshot: rules, globals, facts, agenda, mail, everything that decides
 * what it does next.  docs/mobility.md says what that is.  Between steps only; the mind stays as it
 * is.
 *
 * @return MU_OK; MU_REFUSED: it has what cannot be written down, and fault says what; MU_FULL: out
 *         is too small
 */
MU_MUST_USE mu_result mind_save(struct mind *m, struct mu_text *out, struct mu_fault *fault);

/**
 * Makes a mind that was begun without rules_folder, and has loaded nothing, what a snapshot says.
 * When its own name is another one than the snapshot's, it is a copy with that name.
 *
 * @return MU_OK; MU_FAULT_FILE: the snapshot is not whole, of another version, or says what does
 * not come about; the mind is of no use then
 */
MU_MUST_USE mu_result mind_restore(struct mind *m, const char *snapshot, size_t len,
                                   struct mu_fault *fault);

/**
 * Loads a rule file and resets.
 *
 * @return MU_OK, or MU_FAULT_FILE with file, line and what CLIPS said
 */
MU_MUST_USE mu_result mind_load(struct mind *m, const char *path, struct mu_fault *fault);

/** The same with a text; what it extends is in the library.  @param name  for faults */
MU_MUST_USE mu_result mind_load_text(struct mind *m, const char *name, const char *text,
                                     struct mu_fault *fault);

/** @return whether rules or functions that were loaded send mail, or change groups or services, or
 * call what they name only as they go on */
bool mind_speaks(const struct mind *m);

/** Sets a global that the rules or the library define, e.g. "mate" to the field "red". */
MU_MUST_USE mu_result mind_set_global(struct mind *m, const char *name, const char *field);

/**
 * Which sensors the rules look at: by a pattern, by a call of a sensor's function, or on a line.
 * Loading, lines and rules that build rules change it.
 *
 * @return bits of enum mu_sense
 */
uint32_t mind_senses(const struct mind *m);

/** Opens a control step: copies the percept, and replaces the percept facts; events become facts;
 * message facts age and go. */
void mind_percept(struct mind *m, const struct mu_percept *percept);

/** The same for a mind that has no body, or has lost it: its percept facts go. */
void mind_feel_nothing(struct mind *m, uint64_t time_ns);

/**
 * Opens a step of a mind that has no body, and is told what it sees: as mind_percept.
 *
 * @param relations  whose facts go: those that it was told of the last step; ends with NULL
 */
void mind_observe(struct mind *m, uint64_t time_ns, const char *const *relations);

/**
 * Tells it one fact, in CLIPS: "(robot (name red) (x 12.0))".
 *
 * @return MU_OK; MU_MALFORMED: it is no fact, or it is one that is there already
 */
mu_result mind_tell(struct mind *m, const char *fact);

/* A slot of a fact that it is told. */
enum mind_slot_kind { MIND_SLOT_SYMBOL, MIND_SLOT_STRING, MIND_SLOT_REAL, MIND_SLOT_COUNT };

struct mind_slot {
    const char *name;
    enum mind_slot_kind kind;
    const char *word; /* of a symbol or a string */
    double real;
    uint64_t count;
};

/**
 * Tells it one fact of a deftemplate, slot by slot, which is a tenth of the work of a text.
 *
 * @param slots  single ones, fastest in the order of the deftemplate; others have their defaults
 * @return MU_OK; MU_MALFORMED: there is no such deftemplate or slot, or that fact is there already
 */
mu_result mind_tell_slots(struct mind *m, const char *relation, const struct mind_slot *slots,
                          size_t count);

/** @return whether a pattern or a query of some construct looks at facts of that relation, or
 * a person watches them */
bool mind_looks_at(const struct mind *m, const char *relation);

/**
 * Takes a mail in: a message fact when its language is clips, and its place in the queue.
 *
 * The queue holds 1024 mail facts that rules have not taken yet.  A mail becomes one when a rule's
 * pattern fits it or a function looks at mail facts; any other waits as text for (getmsg).  There
 * the oldest give way to the newest, unless a construct calls (getmsg): then they are a queue, too,
 * of 1024 mails and 256 KiB.
 *
 * @return MU_OK, or MU_FULL: the queue is full, and the mail was refused; its message fact is there
 *         all the same
 */
MU_MUST_USE mu_result mind_take_mail(struct mind *m, const struct mind_mail *mail);

/** @return whether rules have a handler of that layer: (on-layer) */
bool mind_has_layer(const struct mind *m, uint32_t layer);

/**
 * Hands a mail to the rules' handlers of its layer, the youngest first, until one takes it.
 *
 * @return whether one has
 */
bool mind_handle(struct mind *m, const struct mind_mail *mail);

/**
 * Answers a question of one word by the deffunction (answer-WORD), if there is one without
 * arguments: the fields that it returns, or one field.  FALSE is no answer.
 *
 * @return whether there is an answer; out has it
 */
bool mind_answer(struct mind *m, const struct mind_mail *mail, struct mu_text *out);

/** @return the scheme of the addresses that rules resolve: (on-resolve); "": none */
const char *mind_scheme(const struct mind *m);

/**
 * Calls the rules' resolver of addresses.
 *
 * @param rest   what stands behind the colon
 * @param names  the names of the receivers are added, joined by commas
 * @return whether there is such an address; not if the resolver ends in an error
 */
bool mind_resolve(struct mind *m, const char *rest, const char *sender, struct mu_text *names);

/**
 * @return whether a mail that no handler took is one for mind_take_mail: an answer; a speech act
 *         whose performative is empty, KQML's or FIPA's; any of a higher layer with a handler
 */
bool mind_understands(const struct mind *m, const struct mind_mail *mail);

/** Something in the agent's life: (event on-run), ... becomes a fact when the next step opens; that
 * it leaves or arrives, if a rule's pattern looks at events. */
void mind_event(struct mind *m, enum mu_event event);

/** The same at once, for what cannot wait: when a rule is about to fire for it, all that are on the
 * agenda do once more, outside of a step; else none does. */
void mind_event_now(struct mind *m, enum mu_event event, struct mind_act *act);

/** The broker refused a change: (event refused group-create scouts group-exists). */
void mind_refused(struct mind *m, const char *change, const char *reason);

/** A mail did not get through: (event refused send nobody unknown-name), if a rule's pattern looks
 * at events.  @param verb  send, or you-do  @param to  as it was addressed; cut if it is long */
void mind_mail_returned(struct mind *m, const char *verb, const char *to, const char *outcome);

/**
 * Lists facts as (facts) does, as many as fit.
 *
 * @param relation  the template whose facts are wanted; "": all facts
 * @return MU_OK, or MU_ABSENT: no fact of that name was ever there, and out says so
 */
mu_result mind_facts(struct mind *m, const char *relation, struct mu_text *out);

/** Fires rules until the agenda is empty, (update-sensors) was called, or the budget is used. */
void mind_fire(struct mind *m, struct mind_act *act);

/** The same with a smaller budget. */
void mind_fire_some(struct mind *m, uint32_t most, struct mind_act *act);

/**
 * Does what a person or another agent typed: a command, an expression or a construct.
 *
 * @param out   what it printed, or its value, or the error
 * @return MU_OK; MU_MALFORMED: CLIPS refused it, and out says why
 */
MU_MUST_USE mu_result mind_line(struct mind *m, const char *line, struct mu_text *out);

/**
 * Answers a line that only looks (core/probe.h), from what the mind is between two steps, and
 * leaves it as it was: the same snapshot, and the same run, as without the look.
 *
 * @param out   what it printed, or its value, or the error
 * @return MU_OK; MU_MALFORMED: CLIPS refused it; MU_ABSENT: it does not only look, or means
 *         something else to these rules, and nothing was done
 */
MU_MUST_USE mu_result mind_probe(struct mind *m, const char *line, struct mu_text *out);

/** What rules have failed at is forgotten: they may try again. */
void mind_forgive(struct mind *m);

/**
 * What was said last since this was asked last: (run), (resume), (continue); (run N), (step N);
 * (suspend).  In rules only the last counts.
 *
 * @param rules  out: of MIND_WISH_STEP: how many
 */
enum mind_wish mind_wish(struct mind *m, uint32_t *rules);

/** It goes on after a break: the rule that it stopped before may fire once. */
void mind_go_on(struct mind *m);

/**
 * Lists the words that a line may have: one a line, first its kind: f a function, command or
 * construct, r a rule, t a relation, g a global.
 */
void mind_words(struct mind *m, struct mu_text *out);

/**
 * Adds what went on since this was asked last, in the lines of docs/reference/frame.md; nothing
 * unless the options want a trace.  At most 16 KiB; lines without room are counted in the last one.
 */
void mind_trace(struct mind *m, struct mu_text *out);

/** Writes what it wants: the words of its youngest fact (goal ...); "": it has none. */
void mind_goal(struct mind *m, char goal[MU_FIELD_MAX + 1]);

/** Takes where rules or a line want it to go; the first that they said since this was asked. */
struct mind_travel mind_travel(struct mind *m);

/** Writes the table of functions that rules may call, as Markdown: 32 KiB hold it. */
void mind_functions(struct mu_text *out);

#endif
