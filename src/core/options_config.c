/* SPDX-License-Identifier: Apache-2.0 */
#include "core/options.h"

#include "core/fault.h"
#include "core/text.h"
#include "muster/memory.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OPTIONS_LINE_MAX = 1024, OPTIONS_PATH_MAX = 256 };

static bool option_in_range(const struct mu_option *option, double value,
                            char why[MU_OPTION_WHY_MAX])
{
    bool any = !(option->min < option->max || option->min > option->max);
    if (any || (value >= option->min && value <= option->max)) {
        return true;
    }
    snprintf(why, MU_OPTION_WHY_MAX, "expected %.10g to %.10g", option->min, option->max);
    return false;
}

static bool option_set_flag(struct mu_option *option, const char *value,
                            char why[MU_OPTION_WHY_MAX])
{
    static const char *const yes[] = {"yes", "true", "on", "1"};
    static const char *const no[] = {"no", "false", "off", "0"};
    for (size_t i = 0; i < sizeof yes / sizeof yes[0]; i++) {
        bool is_yes = strcmp(value, yes[i]) == 0;
        if (is_yes || strcmp(value, no[i]) == 0) {
            *(bool *)option->target = is_yes;
            return true;
        }
    }
    snprintf(why, MU_OPTION_WHY_MAX, "expected yes or no");
    return false;
}

static bool option_set_string(struct mu_option *option, const char *value,
                              char why[MU_OPTION_WHY_MAX])
{
    (void)why;
    *(const char **)option->target = value;
    return true;
}

static bool option_set_integer(struct mu_option *option, const char *value,
                               char why[MU_OPTION_WHY_MAX])
{
    char *end;
    errno = 0;
    long long number = strtoll(value, &end, 10);
    if (end == value || *end || isspace((unsigned char)value[0])) {
        snprintf(why, MU_OPTION_WHY_MAX, "expected a whole number");
        return false;
    }
    if (errno == ERANGE) {
        snprintf(why, MU_OPTION_WHY_MAX, "expected a whole number of at most 63 bits");
        return false;
    }
    if (!option_in_range(option, (double)number, why)) {
        return false;
    }
    *(int64_t *)option->target = number;
    return true;
}

static bool option_set_real(struct mu_option *option, const char *value,
                            char why[MU_OPTION_WHY_MAX])
{
    char *end;
    double number = strtod(value, &end);
    if (end == value || *end || isspace((unsigned char)value[0]) || !isfinite(number)) {
        snprintf(why, MU_OPTION_WHY_MAX, "expected a number");
        return false;
    }
    if (!option_in_range(option, number, why)) {
        return false;
    }
    *(double *)option->target = number;
    return true;
}

static bool option_add_item(struct mu_option_list *list, const char *item,
                            char why[MU_OPTION_WHY_MAX])
{
    if (list->count == MU_OPTION_LIST_MAX) {
        snprintf(why, MU_OPTION_WHY_MAX, "more than %d of them", MU_OPTION_LIST_MAX);
        return false;
    }
    list->items[list->count++] = item;
    return true;
}

/* Cuts comment and blanks at both ends; a # inside a word stays. */
static char *config_trim(char *line)
{
    line += strspn(line, " \t\r\n");
    for (char *c = line; *c; c++) {
        if (*c == '#' && (c == line || isspace((unsigned char)c[-1]))) {
            *c = '\0';
            break;
        }
    }
    size_t len = strlen(line);
    while (len > 0 && isspace((unsigned char)line[len - 1])) {
        line[--len] = '\0';
    }
    return line;
}

static bool option_set_list(struct mu_option *option, const char *value,
                            char why[MU_OPTION_WHY_MAX])
{
    struct mu_option_list *list = option->target;
    bool typed = option->source == MU_OPTION_COMMAND_LINE;
    if (typed && !option->commas) {
        return option_add_item(list, value, why);
    }
    list->count = typed ? list->count : 0;
    char *rest = mu_startup_string(value);
    for (char *item; (item = strsep(&rest, ",")) != NULL;) {
        item = config_trim(item);
        if ((item[0] || typed) && !option_add_item(list, item, why)) {
            return false;
        }
    }
    return true;
}

bool mu_option_set(struct mu_option *option, const char *value, char why[MU_OPTION_WHY_MAX])
{
    static bool (*const set[])(struct mu_option *, const char *,
                               char[MU_OPTION_WHY_MAX]) = {[MU_OPTION_FLAG] = option_set_flag,
                                                           [MU_OPTION_STRING] = option_set_string,
                                                           [MU_OPTION_INTEGER] = option_set_integer,
                                                           [MU_OPTION_REAL] = option_set_real,
                                                           [MU_OPTION_LIST] = option_set_list};
    return set[option->kind](option, value, why);
}

struct mu_option *mu_options_find(const struct mu_options *options, const char *name)
{
    for (size_t i = 0; i < options->count; i++) {
        if (strcmp(options->table[i].name, name) == 0) {
            return &options->table[i];
        }
    }
    return NULL;
}

/* Takes one trimmed, non-empty line. */
static mu_result config_take_line(struct mu_options *o, char *line, const char *path, int number)
{
    struct mu_fault fault;
    char why[MU_OPTION_WHY_MAX];
    char *equals = strchr(line, '=');
    if (!equals || equals == line) {
        mu_fault_at(&fault, path, number, 0, "expected 'name = value', not '%s'", line);
        mu_fault_print(&fault);
        return MU_FAULT_FILE;
    }
    *equals = '\0';
    char *value = equals + 1 + strspn(equals + 1, " \t");
    struct mu_option *option = mu_options_find(o, config_trim(line));
    if (!option || !option->environment || option->source == MU_OPTION_COMMAND_LINE) {
        return MU_OK;
    }
    option->source = MU_OPTION_CONFIG;
    if (!mu_option_set(option, mu_startup_string(value), why)) {
        mu_fault_at(&fault, path, number, 0, "%s = %s: %s", option->name, value, why);
        mu_fault_print(&fault);
        return MU_FAULT_FILE;
    }
    snprintf(option->place, sizeof option->place, "%.*s:%d", OPTIONS_PATH_MAX, path, number);
    return MU_OK;
}

/* @return whether there is a path; the usual file need not exist */
static bool config_find_usual(char path[OPTIONS_PATH_MAX])
{
    const char *folder = getenv("XDG_CONFIG_HOME");
    const char *home = getenv("HOME");
    struct mu_text text = mu_text_in(path, OPTIONS_PATH_MAX);
    if (folder && folder[0]) {
        mu_text_format(&text, "%s/muster/config", folder);
    } else if (home && home[0]) {
        mu_text_format(&text, "%s/.config/muster/config", home);
    }
    return text.len > 0 && !text.cut;
}

static mu_result config_read_lines(struct mu_options *o, FILE *file, const char *path)
{
    char line[OPTIONS_LINE_MAX];
    for (int number = 1; fgets(line, sizeof line, file); number++) {
        if (strlen(line) == sizeof line - 1) {
            struct mu_fault fault;
            mu_fault_at(&fault, path, number, 0, "expected a line of less than %d bytes",
                        OPTIONS_LINE_MAX);
            mu_fault_print(&fault);
            return MU_FAULT_FILE;
        }
        char *words = config_trim(line);
        mu_result taken = words[0] ? config_take_line(o, words, path, number) : MU_OK;
        if (taken != MU_OK) {
            return taken;
        }
    }
    return MU_OK;
}

mu_result mu_options_read_config(struct mu_options *options, const char *path)
{
    char usual[OPTIONS_PATH_MAX];
    path = path ? path : getenv("MUSTER_CONFIG");
    bool named = path && path[0];
    if (!named) {
        if (!config_find_usual(usual)) {
            return MU_OK;
        }
        path = usual;
    }
    FILE *file = fopen(path, "re");
    if (!file) {
        if (!named && (errno == ENOENT || errno == ENOTDIR)) {
            return MU_OK;
        }
        struct mu_fault fault;
        mu_fault_at(&fault, path, 0, 0, "cannot read the configuration file: %s", strerror(errno));
        mu_fault_print(&fault);
        return MU_FAULT_FILE;
    }
    mu_result result = config_read_lines(options, file, path);
    fclose(file);
    return result;
}
