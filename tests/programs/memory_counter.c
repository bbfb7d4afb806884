/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Counts the calls of an allocator by libmuster itself: the linker puts these functions in the
 * place of the C library's in all that is linked statically, and DDS is not. memory_counter DOMAIN
 * MAILS Sends itself that many mails, one for each that comes, and prints "N mails, N calls".
 */
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t bytes);
void *__real_realloc(void *p, size_t bytes);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t bytes);
void *__wrap_realloc(void *p, size_t bytes);

static unsigned calls;
static unsigned long taken;

void *__wrap_malloc(size_t bytes)
{
    calls++;
    return __real_malloc(bytes);
}

void *__wrap_calloc(size_t count, size_t bytes)
{
    calls++;
    return __real_calloc(count, bytes);
}

void *__wrap_realloc(void *p, size_t bytes)
{
    calls++;
    return __real_realloc(p, bytes);
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)mail;
    taken++;
    if (mu_agent_broadcast(a, "x") != MU_OK ||
        mu_agent_send(a, &(struct mu_mail){.dst = "echo", .content = "again"}, NULL) != MU_OK) {
        fputs("the outbox is full\n", stderr);
    }
}

int main(int argc, char **argv)
{
    struct mu_process_options options = {.domain = argc > 1 ? (int)strtol(argv[1], NULL, 10) : 0};
    unsigned long wanted = argc > 2 ? strtoul(argv[2], NULL, 10) : 100;
    struct mu_handlers handlers = {.on_mail = on_mail};
    mu_process *p;
    mu_agent *a;
    if (mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, "echo", MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        return 4;
    }
    mu_memory_seal();
    if (calls == 0) {
        fputs("the count does not work: joining takes memory\n", stderr);
        return 2;
    }
    calls = 0;
    mu_result going = mu_process_await_broker(p, 5000000000u);
    going = going == MU_OK ? mu_agent_send(a, &(struct mu_mail){.dst = "echo"}, NULL) : going;
    for (time_t until = time(NULL) + 20; going == MU_OK && taken < wanted && time(NULL) < until;) {
        going = mu_process_spin(p, 10000000);
    }
    mu_process_close(p);
    printf("%lu mails, %u calls\n", taken, calls);
    return going == MU_OK && taken >= wanted && calls == 0 ? 0 : 1;
}
