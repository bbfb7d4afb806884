/* SPDX-License-Identifier: Apache-2.0 */
#include "core/log.h"

#include "core/clock.h"
#include "core/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char *log_component = "muster";
static enum mu_log_level log_most = MU_LOG_WARNING;

void mu_log_open(const char *component, enum mu_log_level most)
{
    log_component = component;
    log_most = most;
}

/* A stranger's words in the log stay on one line and move no cursor. */
static void details_add(struct mu_text *line, char *details)
{
    size_t len = strlen(details);
    while (len > 0 && strchr(" \r\n", details[len - 1])) {
        len--;
    }
    for (char *c = details; c < details + len; c++) {
        *c = *c == '\n' ? ' ' : *c;
    }
    mu_text_add_plain(line, details, len);
}

void mu_log(enum mu_log_level level, const char *event, const char *format, ...)
{
    static const char *const words[] = {"error", "warning", "info", "debug"};
    if (level > log_most) {
        return;
    }
    char details[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(details, sizeof details, format, args);
    va_end(args);

    char buffer[1200];
    struct mu_text line = mu_text_in(buffer, sizeof buffer);
    uint64_t now_ms = mu_clock_wall_ns() / 1000000u;
    mu_text_format(&line, "%llu.%03llu %s %s %s ", (unsigned long long)(now_ms / 1000u),
                   (unsigned long long)(now_ms % 1000u), words[level], log_component, event);
    details_add(&line, details);
    line.len = line.len < sizeof buffer - 2 ? line.len : sizeof buffer - 2;
    buffer[line.len] = '\0';
    mu_text_add(&line, "\n");
    /* One write, so that the lines of processes that share a terminal do not mix. */
    ssize_t written = write(STDERR_FILENO, line.at, line.len);
    (void)written;
}
