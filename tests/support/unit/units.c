/* SPDX-License-Identifier: Apache-2.0 */
/* One program for the unit tests of a module.  Each file is a topic with a main of its own, and a
 * run is of one topic, so that what is static in one never meets another: MODULE TOPIC; without a
 * topic it lists them. */
#include "units.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
    for (const struct unit *u = units; u->topic; u++) {
        if (argc < 2) {
            puts(u->topic);
        } else if (strcmp(u->topic, argv[1]) == 0) {
            return u->run();
        }
    }
    if (argc >= 2) {
        fprintf(stderr, "%s: no topic is named %s\n", argv[0], argv[1]);
    }
    return argc < 2 ? EXIT_SUCCESS : EXIT_FAILURE;
}
