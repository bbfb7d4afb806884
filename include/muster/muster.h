/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file muster.h
 * All of libmuster: agent.h for a controller, directory.h for groups and services, kind.h for
 * layers of mail, monitor.h and stats.h for a look at runs.
 */
#ifndef MUSTER_MUSTER_H
#define MUSTER_MUSTER_H

#include "muster/agent.h"
#include "muster/directory.h"
#include "muster/kind.h"
#include "muster/limits.h"
#include "muster/memory.h"
#include "muster/monitor.h"
#include "muster/percept.h"
#include "muster/refusal.h"
#include "muster/resolver.h"
#include "muster/result.h"
#include "muster/sensors.h"
#include "muster/stats.h"
#include "muster/version.h"

#endif
