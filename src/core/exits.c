/* SPDX-License-Identifier: Apache-2.0 */
#include "core/exits.h"

static const struct mu_exit_row exit_rows[] = {
    {MU_EXIT_DONE, "done", "done"},
    {MU_EXIT_EXPECTATION, "expectation", "an expectation failed, or a comparison differs"},
    {MU_EXIT_USAGE, "usage", "wrong usage"},
    {MU_EXIT_FILE, "file", "a bad file"},
    {MU_EXIT_DDS, "no-answer", "no process answers"},
    {MU_EXIT_CRASH, "crash", "a process of the run crashed"},
    {MU_EXIT_REFUSED, "refused", "refused: by policy, by the agent's state, or a held name"},
    {MU_EXIT_NO_AGENT, "unknown", "no such agent, group or service, or no agent fits the address"},
    {MU_EXIT_UNDELIVERED, "undelivered",
     "not delivered: expired, dropped, no room; or refused by an answer"},
    {MU_EXIT_WRITE, "write", "cannot write"},
    {MU_EXIT_SEVERAL, "ambiguous", "several runs live: say which"},
    {MU_EXIT_NETWORK, "network", "no such network, interface or domain"},
    {MU_EXIT_UNDONE, "undone", "something that the experiment named did not happen"},
    {MU_EXIT_OTHER, "other", "another version, program or arithmetic than the recording's"},
    {MU_EXIT_TIME, "time", "time limit, or an answer that did not come"},
    {MU_EXIT_INTERRUPTED, "interrupted", "interrupted"},
};

const struct mu_exit_row *mu_exit_at(size_t index)
{
    return index < sizeof exit_rows / sizeof exit_rows[0] ? &exit_rows[index] : NULL;
}

const struct mu_exit_row *mu_exit_find(int code)
{
    const struct mu_exit_row *row;
    for (size_t i = 0; (row = mu_exit_at(i)); i++) {
        if (row->code == code) {
            return row;
        }
    }
    return mu_exit_find(MU_EXIT_CRASH);
}

int mu_exit_for(mu_result r)
{
    switch (r) {
    case MU_OK:
    case MU_DONE: return MU_EXIT_DONE;
    case MU_FAULT_USAGE: return MU_EXIT_USAGE;
    case MU_FAULT_FILE:
    case MU_MALFORMED: return MU_EXIT_FILE;
    case MU_FAULT_DDS: return MU_EXIT_NETWORK;
    case MU_BUSY:
    case MU_TIMEOUT:
    case MU_NAME_HELD: return MU_EXIT_DDS;
    case MU_REFUSED: return MU_EXIT_REFUSED;
    case MU_ABSENT: return MU_EXIT_NO_AGENT;
    case MU_EXISTS:
    case MU_FULL:
    case MU_DUPLICATE: return MU_EXIT_UNDELIVERED;
    case MU_FAULT_OS: return MU_EXIT_WRITE;
    }
    return MU_EXIT_CRASH;
}
