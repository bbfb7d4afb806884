/* SPDX-License-Identifier: Apache-2.0 */
/* The rules of isolation between a run that goes in lock step and everything else: tables alone. */
#include "broker/steps/steps.h"

/* What holds of one agent or process. */
enum rule { RULE_INSIDE, RULE_PACED, RULE_WAITS, RULE_TOLD, RULE_SHOWN_LINES, RULES };

static const bool rules[RULES][SCOPES] = {
    [RULE_INSIDE] = {[SCOPE_RUN] = true},
    [RULE_PACED] = {[SCOPE_BESIDE] = true, [SCOPE_RUN] = true},
    [RULE_WAITS] = {[SCOPE_AWAITED] = true},
    [RULE_TOLD] = {[SCOPE_OPEN] = true,
                   [SCOPE_AWAITED] = true,
                   [SCOPE_BESIDE] = true,
                   [SCOPE_BROKER] = true,
                   [SCOPE_PART] = true},
    [RULE_SHOWN_LINES] = {[SCOPE_OPEN] = true, [SCOPE_RUN] = true},
};

/* What one has to do with another; an agent outside has to do with all. */
enum relation { RELATION_SEES, RELATION_ADDRESSES, RELATION_CROSSES, RELATIONS };

static const bool of_run[RELATIONS][SCOPES] = {
    [RELATION_SEES] = {[SCOPE_RUN] = true, [SCOPE_BROKER] = true},
    [RELATION_ADDRESSES] = {[SCOPE_OPEN] = true,
                            [SCOPE_AWAITED] = true,
                            [SCOPE_BESIDE] = true,
                            [SCOPE_RUN] = true,
                            [SCOPE_BROKER] = true},
    [RELATION_CROSSES] = {[SCOPE_OPEN] = true, [SCOPE_AWAITED] = true, [SCOPE_BESIDE] = true},
};

enum scope scope_of_agent(enum scope process, bool looks_on, bool awaited)
{
    if (process == SCOPE_RUN) {
        return looks_on ? SCOPE_BESIDE : SCOPE_RUN;
    }
    return awaited ? SCOPE_AWAITED : SCOPE_OPEN;
}

enum scope scope_of_role(enum role role)
{
    static const enum scope scopes[ROLES] = {
        [ROLE_OUTSIDE] = SCOPE_OPEN,          [ROLE_SIMULATOR] = SCOPE_BESIDE,
        [ROLE_SIMULATOR_OWED] = SCOPE_BESIDE, [ROLE_AWAITED] = SCOPE_RUN,
        [ROLE_AWAITED_OWED] = SCOPE_RUN,      [ROLE_ANSWERED] = SCOPE_RUN,
        [ROLE_ANSWERED_OWED] = SCOPE_RUN};
    return scopes[role];
}

enum scope scope_of_line(bool is_part)
{
    return is_part ? SCOPE_PART : SCOPE_BROKER;
}

enum scope scope_of_word(bool in_step)
{
    return in_step ? SCOPE_RUN : SCOPE_OPEN;
}

bool scope_is_inside(enum scope scope)
{
    return rules[RULE_INSIDE][scope];
}

bool scope_is_paced(enum scope scope)
{
    return rules[RULE_PACED][scope];
}

bool scope_waits(enum scope scope)
{
    return rules[RULE_WAITS][scope];
}

bool scope_is_told(enum scope scope)
{
    return rules[RULE_TOLD][scope];
}

bool scope_is_shown_lines(enum scope scope)
{
    return rules[RULE_SHOWN_LINES][scope];
}

bool scope_sees(enum scope asker, enum scope agent)
{
    return asker != SCOPE_RUN || of_run[RELATION_SEES][agent];
}

bool scope_addresses(enum scope sender, enum scope agent)
{
    return sender != SCOPE_RUN || of_run[RELATION_ADDRESSES][agent];
}

bool scope_crosses(enum scope sender, enum scope agent)
{
    return sender == SCOPE_RUN && of_run[RELATION_CROSSES][agent];
}

enum quota_side scope_account(enum scope payer)
{
    return scope_is_inside(payer) ? QUOTA_INSIDE : QUOTA_OUTSIDE;
}

const char *scope_refuses_move(enum scope from, enum scope to)
{
    return from == SCOPE_RUN && to != SCOPE_RUN ? "lock-step" : NULL;
}

const char *scope_refuses_counters(enum scope asker)
{
    return scope_is_inside(asker) ? "in-lock-step" : NULL;
}
