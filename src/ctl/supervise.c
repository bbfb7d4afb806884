/* SPDX-License-Identifier: Apache-2.0 */
#include "ctl/supervise.h"

#include "core/clock.h"
#include "core/paths.h"
#include "core/text.h"
#include "muster/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

void supervise_init(struct supervise *s, bool quiet, bool spread)
{
    *s = (struct supervise){.quiet = quiet};
    s->spread = sched_getaffinity(0, sizeof s->processors, &s->processors) == 0 && spread;
    s->children = mu_startup_array(SUPERVISE_CHILDREN_MAX, sizeof *s->children);
}

/* Finds the processor of the next child: they take turns. */
static cpu_set_t processor_choose(const struct supervise *s, const struct child *child)
{
    cpu_set_t one = s->processors;
    if (!s->spread) {
        return one; /* on a machine with more than CPU_SETSIZE of them, we know of none */
    }
    int turn = (int)((uint32_t)(child - s->children) % (uint32_t)CPU_COUNT(&s->processors));
    for (int cpu = 0; cpu < CPU_SETSIZE; cpu++) {
        if (CPU_ISSET(cpu, &s->processors) && turn-- == 0) {
            CPU_ZERO(&one);
            CPU_SET(cpu, &one);
        }
    }
    return one;
}

/* In the child, between fork and exec: nothing here may allocate. */
static _Noreturn void child_become(const char *path, const char *const *argv, int output,
                                   pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) {
        _exit(127); /* it died before the line above */
    }
    setpgid(0, 0); /* Ctrl-C is the parent's business */
    int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    execv(path, (char *const *)(const void *)argv);
    static const char said[] = "cannot start: the program is missing\n";
    ssize_t written = write(STDERR_FILENO, said, sizeof said - 1);
    (void)written;
    _exit(127);
}

static mu_result child_start(const struct supervise *s, struct child *child, const char *program,
                             const char *const *argv)
{
    char path[PATH_MAX];
    int ends[2];
    if (!mu_path_program(path, sizeof path, program) || pipe2(ends, O_CLOEXEC) != 0) {
        fprintf(stderr, "muster: cannot start %s: %s\n", program, strerror(errno));
        return MU_FAULT_OS;
    }
    pid_t parent = getpid();
    cpu_set_t processors = processor_choose(s, child);
    pid_t pid = fork();
    if (pid == 0) {
        if (s->spread && !child->wide) {
            sched_setaffinity(0, sizeof processors, &processors);
        }
        child_become(path, argv, ends[1], parent);
    }
    close(ends[1]);
    if (pid < 0) {
        close(ends[0]);
        fprintf(stderr, "muster: cannot start %s: %s\n", program, strerror(errno));
        return MU_FAULT_OS;
    }
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    child->pid = pid;
    child->output = ends[0];
    child->ended = false;
    child->words_len = 0;
    child->words[0] = '\0';
    return MU_OK;
}

static mu_result child_add(struct supervise *s, const char *name, const char *program,
                           const char *const *argv, bool wide)
{
    if (s->count == SUPERVISE_CHILDREN_MAX) {
        return MU_FULL;
    }
    struct child *child = &s->children[s->count];
    *child = (struct child){.output = -1, .wide = wide};
    mu_text_copy(child->name, sizeof child->name, name);
    mu_result started = child_start(s, child, program, argv);
    s->count += started == MU_OK;
    return started;
}

mu_result supervise_start(struct supervise *s, const char *name, const char *program,
                          const char *const *argv)
{
    struct child *before = supervise_find(s, name);
    if (before && before->ended) {
        return supervise_start_again(s, before, program, argv);
    }
    return child_add(s, name, program, argv, false);
}

mu_result supervise_start_wide(struct supervise *s, const char *name, const char *program,
                               const char *const *argv)
{
    return child_add(s, name, program, argv, true);
}

mu_result supervise_start_again(struct supervise *s, struct child *child, const char *program,
                                const char *const *argv)
{
    MU_ASSERT(child->ended);
    if (child->output >= 0) {
        close(child->output);
        child->output = -1;
    }
    child->struck = false;
    return child_start(s, child, program, argv);
}

/* Keeps the last words, dropping the oldest. */
static void words_keep(struct child *child, const char *said, size_t len)
{
    size_t most = sizeof child->words - 1;
    if (len > most) {
        said += len - most;
        len = most;
    }
    size_t stay = child->words_len < most - len ? child->words_len : most - len;
    memmove(child->words, child->words + child->words_len - stay, stay);
    memcpy(child->words + stay, said, len);
    child->words_len = (uint32_t)(stay + len);
    child->words[child->words_len] = '\0';
}

static void output_read(const struct supervise *s, struct child *child)
{
    char said[4096];
    ssize_t len;
    while (child->output >= 0 && (len = read(child->output, said, sizeof said)) != 0) {
        if (len < 0) {
            return;
        }
        words_keep(child, said, (size_t)len);
        if (!s->quiet) {
            fwrite(said, 1, (size_t)len, stderr);
        }
    }
    if (child->output >= 0) {
        close(child->output);
        child->output = -1;
    }
}

void supervise_look(struct supervise *s)
{
    for (uint32_t i = 0; i < s->count; i++) {
        struct child *child = &s->children[i];
        output_read(s, child);
        if (!child->ended && waitpid(child->pid, &child->status, WNOHANG) == child->pid) {
            child->ended = true;
            output_read(s, child);
        }
    }
}

bool supervise_has_died(const struct child *child)
{
    bool left = child->may_leave && WIFEXITED(child->status) && WEXITSTATUS(child->status) == 0;
    return child->ended && !child->excused && !child->struck && !left;
}

const struct child *supervise_ended(const struct supervise *s)
{
    for (uint32_t i = 0; i < s->count; i++) {
        const struct child *child = &s->children[i];
        if (supervise_has_died(child)) {
            return child;
        }
    }
    return NULL;
}

struct child *supervise_find(struct supervise *s, const char *name)
{
    for (uint32_t i = 0; i < s->count; i++) {
        if (strcmp(s->children[i].name, name) == 0) {
            return &s->children[i];
        }
    }
    return NULL;
}

static bool all_ended(const struct supervise *s)
{
    for (uint32_t i = 0; i < s->count; i++) {
        if (!s->children[i].ended) {
            return false;
        }
    }
    return true;
}

void supervise_signal(struct child *child, int number)
{
    if (!child->ended) {
        kill(child->pid, number);
    }
}

/* one NULL: all of them. */
void supervise_await(struct supervise *s, const struct child *one, int patience_ms)
{
    uint64_t until_ns = mu_clock_ns() + (uint64_t)patience_ms * 1000000u;
    const struct timespec nap = {.tv_nsec = 1000000};
    supervise_look(s);
    while (!(one ? one->ended : all_ended(s)) && mu_clock_ns() < until_ns) {
        nanosleep(&nap, NULL);
        supervise_look(s);
    }
}

void supervise_stop(struct supervise *s, struct child *child, int patience_ms)
{
    supervise_signal(child, SIGTERM);
    supervise_await(s, child, patience_ms);
    supervise_signal(child, SIGKILL);
    supervise_await(s, child, patience_ms);
}

void supervise_stop_all(struct supervise *s, int patience_ms)
{
    for (uint32_t i = 0; i < s->count; i++) {
        supervise_signal(&s->children[i], SIGTERM);
        supervise_signal(&s->children[i], SIGCONT); /* a stopped process hears nothing else */
    }
    supervise_await(s, NULL, patience_ms);
    for (uint32_t i = 0; i < s->count; i++) {
        supervise_signal(&s->children[i], SIGKILL);
    }
    supervise_await(s, NULL, patience_ms);
}

void supervise_explain(const struct child *child)
{
    if (WIFSIGNALED(child->status)) {
        fprintf(stderr, "muster: %s was killed by signal %d (%s)\n", child->name,
                WTERMSIG(child->status), strsignal(WTERMSIG(child->status)));
    } else {
        fprintf(stderr, "muster: %s ended with exit code %d\n", child->name,
                WEXITSTATUS(child->status));
    }
    if (child->words_len > 0) {
        fprintf(stderr, "its last words:\n%s%s", child->words,
                child->words[child->words_len - 1] == '\n' ? "" : "\n");
    }
}
