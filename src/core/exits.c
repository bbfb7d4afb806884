/* SPDX-License-Identifier: Apache-2.0 */
#include "core/exits.h"

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
