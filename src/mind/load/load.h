/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file load.h
 * Rule files and their constructs.
 */
#ifndef MUSTER_MIND_LOAD_H
#define MUSTER_MIND_LOAD_H

#include "mind/functions/functions.h"

enum {
    LOAD_FILE_MAX = 1 << 20, /* bytes of a rule file */
    LOAD_DEEP_MAX = 16,      /* depth of files that extend each other */
};

/* A mind and the memory that loading takes. */
struct mind_loader {
    struct mind_output output; /* first */
    char *text;                /* a stack of the files being read */
    size_t text_used;
    char *form; /* one rewritten form */
    const char *files[LOAD_DEEP_MAX];
    size_t files_deep;
    long error_line;
};

static inline struct mind_loader *loader_of(const struct mind *m)
{
    return (struct mind_loader *)(uintptr_t)m;
}

/** Allocates at start-up. */
void load_reserve(struct mind *m);
void load_install(struct mind *m);

/** Loads the forms of a file in order; (extends) loads another file in its place. */
MU_MUST_USE mu_result load_file(struct mind *m, const char *path, struct mu_fault *fault);
MU_MUST_USE mu_result load_text(struct mind *m, const char *path, const char *at,
                                struct mu_fault *fault);

/** Resets, which asserts the initial facts and sets the globals. */
MU_MUST_USE mu_result load_begin(struct mind *m, const char *path, struct mu_fault *fault);

/** Loads one construct.  @return MU_OK, or MU_FAULT_FILE with what CLIPS said */
MU_MUST_USE mu_result load_construct(struct mind *m, const char *path, struct syntax_form f,
                                     struct mu_fault *fault);

#endif
