/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file refusal.h
 * Why something is refused: a number on the wire (Refusal in idl/wire.idl), and a word in the
 * content of an answer.  Texts for people may change; programs look at these.
 */
#ifndef MUSTER_REFUSAL_H
#define MUSTER_REFUSAL_H

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

/* Name, word, meaning.  The order is that of the wire: new ones come last. */
#define MU_REFUSALS(X)                                                                             \
    X(NONE, "", "")                                                                                \
    X(NAME_HELD, "held", "another participant has that name")                                      \
    X(NOT_A_NAME, "not-a-name", "that cannot be a name here")                                      \
    X(FULL, "full", "the broker has no room for more")                                             \
    X(OUT_OF_DATE, "out-of-date", "the agent has moved on since, or has stayed after all")         \
    X(UNKNOWN_HOST, "unknown-host", "there is no host of that name; muster ps lists them")         \
    X(HOST_ABSENT, "host-absent", "that host is there no more; muster ps lists them")              \
    X(HERE_ALREADY, "here-already", "it is on that host")                                          \
    X(NAME_TAKEN, "name-taken", "another agent has that name; muster ps lists all")                \
    X(BUSY, "busy", "its process sends another agent on its way; try again")                       \
    X(TOO_LARGE, "too-large", "it has more facts and rules than fit into 1 MiB")                   \
    X(STATE, "wrong-state", "its state does not allow that")                                       \
    X(UNSUPPORTED, "unsupported", "it is no agent that can be told so")                            \
    X(POLICY, "refused", "by the trust policy: it takes the right to direct that agent")           \
    X(UNKNOWN_NAME, "unknown-name", "no agent has ever had that name; muster ps lists all agents") \
    X(UNKNOWN_GROUP, "unknown-group", "there is no such group; muster group list lists them")      \
    X(NOT_A_MEMBER, "not-a-member", "it is not in that group")                                     \
    X(NOT_OFFERED, "not-offered",                                                                  \
      "it does not offer that; muster service list lists what is offered")                         \
    X(NOT_ATTRIBUTES, "not-attributes", "expected key=value, separated by spaces")                 \
    X(GROUP_EXISTS, "group-exists", "there is a group of that name")                               \
    X(VERSION, "other-version", "its program is of another version than the broker: use one")

enum mu_refusal {
#define X(name, word, text) MU_REFUSAL_##name,
    MU_REFUSALS(X)
#undef X
};

/** @return the word of a code; "" of MU_REFUSAL_NONE and of an invalid number */
const char *mu_refusal_word(enum mu_refusal code);

/** @return the text of a code for people; "" of MU_REFUSAL_NONE and of an invalid number */
const char *mu_refusal_text(enum mu_refusal code);

/** @return the code of a word; MU_REFUSAL_NONE: it is the word of none */
enum mu_refusal mu_refusal_named(const char *word);

/** @return the code in an answer, of which it is the second word, as in `suspend wrong-state
 *          standby` and `red unknown-host`; MU_REFUSAL_NONE: it has none */
enum mu_refusal mu_refusal_of(const char *content);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
