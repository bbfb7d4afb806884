/* SPDX-License-Identifier: Apache-2.0 */
#include "core/arithmetic.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>

const char *mu_architecture(void)
{
    static struct utsname system;
    return uname(&system) == 0 ? system.machine : "";
}

void mu_processor(char name[MU_PROCESSOR_MAX])
{
    char line[256];
    name[0] = '\0';
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && !name[0] && fgets(line, sizeof line, file)) {
        const char *value = strchr(line, ':');
        bool is_model = strncmp(line, "model name", sizeof "model name" - 1) == 0;
        if (is_model && value) {
            snprintf(name, MU_PROCESSOR_MAX, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
        }
    }
    if (file) {
        fclose(file);
    }
}
