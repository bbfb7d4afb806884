/* SPDX-License-Identifier: Apache-2.0 */
#include "core/fault.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A control character from a file could command a terminal. */
static void text_disarm(char *text)
{
    for (; *text; text++) {
        *text = (unsigned char)*text < ' ' || *text == 0x7f ? '?' : *text;
    }
}

mu_result mu_fault_at(struct mu_fault *fault, const char *file, int line, int column,
                      const char *format, ...)
{
    snprintf(fault->file, sizeof fault->file, "%s", file ? file : "");
    fault->line = line;
    fault->column = column;
    va_list args;
    va_start(args, format);
    vsnprintf(fault->text, sizeof fault->text, format, args);
    va_end(args);
    text_disarm(fault->text);
    return MU_FAULT_FILE;
}

mu_result mu_fault_os(struct mu_fault *fault, const char *file, const char *what)
{
    (void)mu_fault_at(fault, file, 0, 0, "cannot %s: %s", what, strerror(errno));
    return MU_FAULT_OS;
}

void mu_fault_print(const struct mu_fault *fault)
{
    mu_fault_print_to(stderr, fault, "");
}

void mu_fault_print_to(FILE *to, const struct mu_fault *fault, const char *word)
{
    fprintf(to, "%s:", fault->file);
    if (fault->line > 0) {
        fprintf(to, "%d:", fault->line);
    }
    if (fault->line > 0 && fault->column > 0) {
        fprintf(to, "%d:", fault->column);
    }
    fprintf(to, " %s%s\n", word, fault->text);
}
