/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file bus_fault.h
 * A call of DDS that failed is said on stderr.
 */
#ifndef MUSTER_BUS_BUS_FAULT_H
#define MUSTER_BUS_BUS_FAULT_H

#include "muster/result.h"

#include <dds/dds.h>
#include <stdio.h>

static inline mu_result bus_fault(const char *what, dds_return_t code)
{
    fprintf(stderr, "DDS: %s: %s\n", what, dds_strretcode(code));
    return MU_FAULT_DDS;
}

#endif
