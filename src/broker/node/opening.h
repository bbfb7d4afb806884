/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file opening.h
 * Opens the broker, its store and its files as the command line says.
 */
#ifndef MUSTER_BROKER_OPENING_H
#define MUSTER_BROKER_OPENING_H

#include "broker/control/broker.h"
#include "broker/node/disk.h"
#include "broker/node/files.h"
#include "broker/node/settings.h"

struct opening {
    struct broker *broker;
    struct disk *disk; /* NULL: without a store */
    struct files_audit audit;
    struct broker_options options; /* its strings live as long as the command line does */
};

/** @return MU_EXIT_DONE, or the exit code, explained */
int opening_run(struct opening *o, const struct settings *s, const char *name);

#endif
