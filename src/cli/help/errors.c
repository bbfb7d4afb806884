/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Errors for programs: with --json, what a verb that fails says is one object on standard error.
 *
 * The verb runs in a child, so that what it says is not lost, however it ends.
 */
#include "cli/help/help.h"
#include "core/exits.h"
#include "core/json.h"
#include "core/text.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SAID_MAX = 64 * 1024 };

static volatile sig_atomic_t child_pid;

static void signal_pass(int number)
{
    if (child_pid > 0) {
        (void)kill((pid_t)child_pid, number);
    }
}

static void signals_pass(void)
{
    const struct sigaction pass = {.sa_handler = signal_pass};
    sigaction(SIGINT, &pass, NULL);
    sigaction(SIGTERM, &pass, NULL);
    sigaction(SIGHUP, &pass, NULL);
}

bool errors_are_json(int count, char **words)
{
    for (int i = 1; i < count && strcmp(words[i], "--") != 0; i++) {
        if (strcmp(words[i], "--json") == 0) {
            return true;
        }
    }
    return false;
}

void errors_print(int code, const char *message)
{
    const struct mu_exit_row *row = mu_exit_find(code);
    struct mu_json j = mu_json_line(stderr);
    mu_json_string(&j, "error", row->word);
    mu_json_int(&j, "exit", code);
    mu_json_string(&j, "message", message[0] ? message : row->meaning);
    mu_json_end(&j);
}

/* Takes what the child says until it has ended.  What does not fit is left out. */
static void said_read(int from, struct mu_text *said)
{
    char bytes[4096];
    for (;;) {
        ssize_t len = read(from, bytes, sizeof bytes);
        if (len == 0 || (len < 0 && errno != EINTR)) {
            return;
        }
        if (len > 0) {
            mu_text_add_bytes(said, bytes, (size_t)len);
        }
    }
}

/* @return the exit code of the child */
static int child_await(void)
{
    int status = 0;
    while (waitpid((pid_t)child_pid, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status)                                           ? WEXITSTATUS(status)
           : WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM ? MU_EXIT_INTERRUPTED
                                                                       : MU_EXIT_CRASH;
}

bool errors_catch(int *code)
{
    static char bytes[SAID_MAX];
    struct mu_text said = mu_text_in(bytes, sizeof bytes);
    pid_t parent = getpid();
    int ends[2];
    if (pipe(ends) != 0) {
        return true;
    }
    signals_pass();
    child_pid = fork();
    if (child_pid <= 0) {
        signal(SIGINT, SIG_DFL);
        signal(SIGTERM, SIG_DFL);
        signal(SIGHUP, SIG_DFL);
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (child_pid == 0 && getppid() == parent) {
            dup2(ends[1], STDERR_FILENO);
        }
        close(ends[0]);
        close(ends[1]);
        return true;
    }
    close(ends[1]);
    said_read(ends[0], &said);
    close(ends[0]);
    *code = child_await();
    while (said.len > 0 && said.at[said.len - 1] == '\n') {
        said.at[--said.len] = '\0';
    }
    if (*code != MU_EXIT_DONE) {
        errors_print(*code, said.at);
    } else if (said.len > 0) {
        fprintf(stderr, "%s\n", said.at);
    }
    return false;
}
