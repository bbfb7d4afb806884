/* SPDX-License-Identifier: Apache-2.0 */
#include "run/supervise.h"

#include "core/clock.h"
#include "core/paths.h"
#include "core/text.h"
#include "muster/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

volatile sig_atomic_t run_signal;

static void signal_note(int number)
{
    run_signal = number;
}

void supervise_signals_note(void)
{
    struct sigaction note = {.sa_handler = signal_note};
    sigaction(SIGINT, &note, NULL);
    sigaction(SIGTERM, &note, NULL);
    sigaction(SIGHUP, &note, NULL);
}

/* --- command lines ---------------------------------------------------------------------------- */

static struct {
    const char *items[SUPERVISE_LINE_MAX];
    size_t count;
    struct mu_text text;
} line;

void supervise_words(const char *program)
{
    static char bytes[SUPERVISE_LINE_BYTES];
    mu_text_init(&line.text, bytes, sizeof bytes);
    line.count = 0;
    line.items[line.count++] = program;
}

void supervise_word(const char *format, ...)
{
    char word[2 * PATH_MAX + 256];
    va_list args;
    va_start(args, format);
    vsnprintf(word, sizeof word, format, args);
    va_end(args);
    MU_ASSERT(line.count < SUPERVISE_LINE_MAX - 1);
    line.items[line.count++] = line.text.at + line.text.len;
    mu_text_add_bytes(&line.text, word, strlen(word) + 1);
    MU_ASSERT(!line.text.cut);
}

const char *const *supervise_words_end(void)
{
    line.items[line.count] = NULL;
    return line.items;
}

/* --- processes -------------------------------------------------------------------------------- */

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

enum { READY_FD = 3 }; /* of the child */
#define READY_NAME "MUSTER_READY"

/* Where a child's outputs go, and where it says that it is ready, if it is to. */
struct ends {
    int output[2], ready[2];
};

static void ends_close(const struct ends *ends, int which)
{
    close(ends->output[which]);
    if (ends->ready[which] >= 0) {
        close(ends->ready[which]);
    }
}

static bool ends_open(struct ends *ends, bool says_ready)
{
    *ends = (struct ends){.ready = {-1, -1}};
    if (pipe2(ends->output, O_CLOEXEC) != 0) {
        return false;
    }
    if (says_ready && pipe2(ends->ready, O_CLOEXEC) != 0) {
        close(ends->output[0]);
        close(ends->output[1]);
        return false;
    }
    return true;
}

/* It lives on in the program; that of another child closes with it. */
static void fd_become(int fd, int wanted)
{
    if (fd == wanted) {
        fcntl(fd, F_SETFD, 0);
    } else {
        dup2(fd, wanted);
    }
}

/* In the child, between fork and exec: nothing here may allocate. */
static _Noreturn void child_become(const char *path, const char *const *argv,
                                   const struct ends *ends, pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) {
        _exit(127); /* it died before the line above */
    }
    setpgid(0, 0); /* Ctrl-C is the parent's business */
    int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(ends->output[1], STDOUT_FILENO);
    dup2(ends->output[1], STDERR_FILENO);
    if (ends->ready[1] >= 0) {
        fd_become(ends->ready[1], READY_FD);
    }
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
    struct ends ends;
    bool says_ready = child->log >= 0;
    if (!mu_path_program(path, sizeof path, program) || !ends_open(&ends, says_ready)) {
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
        child_become(path, argv, &ends, parent);
    }
    ends_close(&ends, 1);
    if (pid < 0) {
        ends_close(&ends, 0);
        fprintf(stderr, "muster: cannot start %s: %s\n", program, strerror(errno));
        return MU_FAULT_OS;
    }
    fcntl(ends.output[0], F_SETFL, O_NONBLOCK);
    child->pid = pid;
    child->output = ends.output[0];
    child->ready = ends.ready[0];
    child->ended = false;
    child->words_len = 0;
    child->words[0] = '\0';
    return MU_OK;
}

/* like: what is known of it already */
static mu_result child_add(struct supervise *s, const char *name, const char *program,
                           const char *const *argv, const struct child *like)
{
    if (s->count == SUPERVISE_CHILDREN_MAX) {
        return MU_FULL;
    }
    struct child *child = &s->children[s->count];
    *child = *like;
    child->output = child->ready = -1;
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
    return child_add(s, name, program, argv, &(struct child){.log = -1});
}

mu_result supervise_start_wide(struct supervise *s, const char *name, const char *program,
                               const char *const *argv)
{
    return child_add(s, name, program, argv, &(struct child){.log = -1, .wide = true});
}

mu_result supervise_start_aside(struct supervise *s, const char *name, const char *program,
                                const char *const *argv, const char *log)
{
    int fd = open(log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    char number[16];
    if (fd < 0) {
        fprintf(stderr, "muster: cannot write %s: %s\n", log, strerror(errno));
        return MU_FAULT_OS;
    }
    snprintf(number, sizeof number, "%d", READY_FD);
    setenv(READY_NAME, number, 1);
    mu_result started = child_add(s, name, program, argv, &(struct child){.log = fd, .wide = true});
    unsetenv(READY_NAME);
    if (started != MU_OK) {
        close(fd);
    }
    return started;
}

bool supervise_is_ready(const struct child *child)
{
    return child->ready < 0;
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

/* A log that cannot be written ends there, and says so once. */
static void log_write(struct child *child, const char *said, size_t len)
{
    while (len > 0) {
        ssize_t written = write(child->log, said, len);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written < 0) {
            fprintf(stderr, "muster: cannot write what %s says: %s\n", child->name,
                    strerror(errno));
            close(child->log);
            child->log = open("/dev/null", O_WRONLY | O_CLOEXEC);
            return;
        }
        said += written;
        len -= (size_t)written;
    }
}

/* A byte, or that no process holds the other end any more. */
static void ready_read(struct child *child)
{
    struct pollfd look = {.fd = child->ready, .events = POLLIN};
    if (child->ready >= 0 && poll(&look, 1, 0) > 0) {
        close(child->ready);
        child->ready = -1;
    }
}

/* One that says more than this at a time is heard on in the next round. */
enum { OUTPUT_READS = 64 };

static void output_read(const struct supervise *s, struct child *child)
{
    char said[4096];
    ssize_t len = -1;
    for (int i = 0; child->output >= 0 && i < OUTPUT_READS; i++) {
        len = read(child->output, said, sizeof said);
        if (len <= 0) {
            break;
        }
        words_keep(child, said, (size_t)len);
        if (child->log >= 0) {
            log_write(child, said, (size_t)len);
        } else if (!s->quiet) {
            fputs(isatty(STDERR_FILENO) ? "\r\033[K" : "", stderr); /* over the progress */
            fwrite(said, 1, (size_t)len, stderr);
        }
    }
    if (len == 0) {
        close(child->output);
        child->output = -1;
    }
}

/* What it has forked does not outlive it: it leads a group of its own, whose number is taken until
 * it is waited for. */
static bool child_is_over(struct child *child)
{
    siginfo_t is = {.si_pid = 0};
    if (waitid(P_PID, (id_t)child->pid, &is, WEXITED | WNOHANG | WNOWAIT) != 0 || is.si_pid == 0) {
        return false;
    }
    kill(-child->pid, SIGKILL);
    return waitpid(child->pid, &child->status, 0) == child->pid;
}

void supervise_look(struct supervise *s)
{
    for (uint32_t i = 0; i < s->count; i++) {
        struct child *child = &s->children[i];
        output_read(s, child);
        ready_read(child);
        if (!child->ended && child_is_over(child)) {
            child->ended = true;
            child->ended_ns = mu_clock_ns();
            output_read(s, child);
        }
    }
}

bool supervise_has_died(const struct child *child)
{
    bool left = child->may_leave && WIFEXITED(child->status) && WEXITSTATUS(child->status) == 0;
    return child->ended && !child->excused && !child->struck && !left;
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

void supervise_fate(const struct child *child, char *text, size_t size)
{
    if (WIFSIGNALED(child->status)) {
        snprintf(text, size, "was killed by signal %d (%s)", WTERMSIG(child->status),
                 strsignal(WTERMSIG(child->status)));
    } else {
        snprintf(text, size, "ended with exit code %d", WEXITSTATUS(child->status));
    }
}

void supervise_explain(const struct child *child)
{
    char fate[SUPERVISE_FATE_MAX];
    supervise_fate(child, fate, sizeof fate);
    fprintf(stderr, "muster: %s %s\n", child->name, fate);
    if (child->words_len > 0) {
        fprintf(stderr, "its last words:\n%s%s", child->words,
                child->words[child->words_len - 1] == '\n' ? "" : "\n");
    }
}

/* --- haste ------------------------------------------------------------------------------------ */

static const uint64_t HURRY_LOOK_NS = 200000000;

/* Others may take so much of one processor's time: /proc/stat counts in hundredths of a second. */
enum { OTHERS_MAX_PERCENT = 20 };

/* The counters of a processor, in ticks: user, nice, system, idle, iowait, irq, softirq.
 * @return of those, the time at work */
static uint64_t line_read(const char *counters)
{
    unsigned long long n[7] = {0};
    int count = sscanf(counters, "%llu %llu %llu %llu %llu %llu %llu", &n[0], &n[1], &n[2], &n[3],
                       &n[4], &n[5], &n[6]);
    uint64_t ticks = count == 7 ? n[0] + n[1] + n[2] + n[5] + n[6] : 0;
    return ticks * (1000000000u / (uint64_t)sysconf(_SC_CLK_TCK));
}

/* @return how long those processors have worked since the machine was started */
static uint64_t busy_read(const cpu_set_t *processors)
{
    static char text[64 * 1024];
    int fd = open("/proc/stat", O_RDONLY | O_CLOEXEC);
    ssize_t len = fd >= 0 ? read(fd, text, sizeof text - 1) : 0;
    if (fd >= 0) {
        close(fd);
    }
    text[len > 0 ? len : 0] = '\0';
    uint64_t busy_ns = 0;
    for (const char *at = text; (at = strstr(at, "\ncpu"));) {
        int cpu, digits;
        at += strlen("\ncpu");
        if (sscanf(at, "%d%n", &cpu, &digits) == 1 && CPU_ISSET(cpu, processors)) {
            busy_ns += line_read(at + digits);
        }
    }
    return busy_ns;
}

/* @return how long the processes of the run have worked; one that has ended counts no more */
static uint64_t own_read(const struct supervise *s)
{
    clockid_t clock;
    uint64_t own_ns = mu_clock_read(CLOCK_PROCESS_CPUTIME_ID);
    for (uint32_t i = 0; i < s->count; i++) {
        const struct child *child = &s->children[i];
        if (!child->ended && clock_getcpuclockid(child->pid, &clock) == 0) {
            own_ns += mu_clock_read(clock);
        }
    }
    return own_ns;
}

/* A program that has chosen another policy keeps it. */
static void children_become(const struct supervise *s, int policy, int from)
{
    for (uint32_t i = 0; i < s->count; i++) {
        pid_t pid = s->children[i].pid;
        if (!s->children[i].ended && sched_getscheduler(pid) == from) {
            sched_setscheduler(pid, policy, &(struct sched_param){0});
        }
    }
}

void supervise_hurry(struct supervise *s)
{
    struct supervise_haste *h = &s->haste;
    uint64_t now_ns = mu_clock_ns(), passed_ns = now_ns - h->looked_ns;
    if (passed_ns < HURRY_LOOK_NS) {
        return;
    }
    uint64_t busy_ns = busy_read(&s->processors), own_ns = own_read(s);
    int64_t others_ns = (int64_t)(busy_ns - h->busy_ns) - (int64_t)(own_ns - h->own_ns);
    bool alone = others_ns < (int64_t)(passed_ns / 100 * OTHERS_MAX_PERCENT);
    if (h->looked_ns > 0) {
        h->batch = alone;
        children_become(s, alone ? SCHED_BATCH : SCHED_OTHER, alone ? SCHED_OTHER : SCHED_BATCH);
    }
    *h = (struct supervise_haste){h->batch, now_ns, busy_ns, own_ns};
}
