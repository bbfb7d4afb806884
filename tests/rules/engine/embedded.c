/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Runs CLIPS scripts as a robot's mind does: each file is loaded and reset, then rules fire until
 * the agenda is empty.
 *   embedded FILE...
 * Prints what the rules print, and behind each file a line "--- FILE".
 */
#include "core/text_file.h"
#include "mind/mind.h"

#include <stdio.h>

enum { STEPS_MAX = 100000, FIRINGS = 1000000 };

static void print(void *self, const char *text)
{
    (void)self;
    fputs(text, stdout);
}

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    (void)letter;
    return MU_OK;
}

static struct mind *minds[1024]; /* their memory is for the life of the process */

static void run(struct mind **m, const char *path)
{
    struct mu_fault fault;
    struct mind_act act;
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = "blue",
                                   .seed = 1,
                                   .firings_max = FIRINGS,
                                   .ports = {.send = post, .print = print}};
    mu_result r = mind_open(m, &options, &fault);
    r = r == MU_OK ? mind_load(*m, path, &fault) : r;
    if (r != MU_OK) {
        mu_fault_print(&fault);
        return;
    }
    for (int i = 0; i < STEPS_MAX; i++) {
        mind_fire(*m, &act);
        if (act.end == MIND_IDLE || act.end == MIND_STOPPED) {
            break;
        }
    }
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc && i < 1024; i++) {
        run(&minds[i], argv[i]);
        printf("\n--- %s\n", argv[i]);
    }
    return 0;
}
