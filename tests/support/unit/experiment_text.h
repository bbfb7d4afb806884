/* SPDX-License-Identifier: Apache-2.0 */
/* Experiments as text, in a folder with the files that they name. */
#ifndef MUSTER_EXPERIMENT_TEXT_H
#define MUSTER_EXPERIMENT_TEXT_H

#include "core/text.h"
#include "experiment/experiment.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BASE                          \
    "world: a.world\n"                \
    "duration: 120\n"                 \
    "robots:\n"                       \
    "  - {name: red, rules: a.clp}\n" \
    "  - {name: blue, rules: a.clp, body: pioneer, color: '#00f', pose: [1, -2.5, 90]}\n"

static char folder[] = "/tmp/muster-experiment-XXXXXX";
static char path[64];
static struct mu_fault fault;
static struct experiment *e;

static bool file_write(const char *name, const char *text)
{
    char file[64];
    snprintf(file, sizeof file, "%s/%s", folder, name);
    FILE *out = fopen(file, "w");
    if (!out) {
        return false;
    }
    bool written = fputs(text, out) >= 0;
    return fclose(out) == 0 && written;
}

static mu_result load(const char *text, const char *set)
{
    CU_ASSERT_FATAL(file_write("test-1.yaml", text));
    return experiment_load(&e, path, &set, set ? 1 : 0, &fault);
}

#define ROBOT(fields) "world: a.world\nduration: 10\nrobots:\n  - {rules: a.clp, " fields "}\n"

static int folder_make(void)
{
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(path, sizeof path, "%s/test-1.yaml", folder);
    bool written = file_write("a.world", "") && file_write("a.clp", "") && file_write("b.clp", "");
    return written ? 0 : 1;
}

static int folder_remove(void)
{
    static const char *const names[] = {"test-1.yaml", "a.world", "a.clp", "b.clp"};
    int failed = 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char file[64];
        snprintf(file, sizeof file, "%s/%s", folder, names[i]);
        failed |= unlink(file);
    }
    return failed | rmdir(folder);
}

#endif
