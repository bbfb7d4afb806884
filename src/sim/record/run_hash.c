/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "muster/memory.h"
#include "muster/result.h"

#include <openssl/evp.h>
#include <stdio.h>
#include <string.h>

struct run_hash {
    EVP_MD_CTX *run, *act;
    EVP_MD *sha256;
};

struct run_hash *run_hash_open(void)
{
    struct run_hash *h = mu_startup_alloc(sizeof *h);
    h->sha256 = EVP_MD_fetch(NULL, "SHA256", NULL);
    h->run = EVP_MD_CTX_new();
    h->act = EVP_MD_CTX_new();
    MU_ASSERT(h->sha256 && h->run && h->act);
    MU_ASSERT(EVP_DigestInit_ex2(h->run, h->sha256, NULL) == 1);
    return h;
}

static void fold(EVP_MD_CTX *to, const void *bytes, size_t count)
{
    MU_ASSERT(EVP_DigestUpdate(to, bytes, count) == 1);
}

static void fold_number(EVP_MD_CTX *to, uint64_t number)
{
    unsigned char little_endian[8];
    for (size_t i = 0; i < sizeof little_endian; i++) {
        little_endian[i] = (unsigned char)(number >> (8 * i));
    }
    fold(to, little_endian, sizeof little_endian);
}

static void fold_double(EVP_MD_CTX *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    fold_number(to, bits);
}

/* Folds the final zero in, too, so that "ab" "c" and "a" "bc" differ. */
static void fold_text(EVP_MD_CTX *to, const char *text)
{
    fold(to, text, strlen(text) + 1);
}

static void fold_mail(EVP_MD_CTX *to, const muster_Mail *m)
{
    fold_text(to, m->src);
    fold_text(to, m->dst);
    fold_number(to, m->seq);
    fold_number(to, m->layer);
    fold_text(to, m->performative);
    fold_text(to, m->content);
}

void run_hash_act(struct run_hash *h, const muster_Act *act, unsigned char digest[RUN_HASH_BYTES])
{
    MU_ASSERT(EVP_DigestInit_ex2(h->act, h->sha256, NULL) == 1);
    fold_text(h->act, act->agent);
    fold_number(h->act, (uint64_t)act->state);
    fold_number(h->act, act->drives);
    fold_double(h->act, act->forward_m_s);
    fold_double(h->act, act->turn_rad_s);
    if (act->paddles != 0 ||
        act->lift != 0) { /* keeps the digests of acts without orders to a gripper */
        fold_text(h->act, "grip");
        fold_number(h->act, (uint64_t)act->paddles);
        fold_number(h->act, (uint64_t)act->lift);
    }
    fold_number(h->act, act->firings);
    fold_text(h->act, act->rules);
    for (uint32_t i = 0; i < act->mails._length; i++) {
        fold_mail(h->act, &act->mails._buffer[i]);
    }
    MU_ASSERT(EVP_DigestFinal_ex(h->act, digest, NULL) == 1);
}

void run_hash_fold(struct run_hash *h, const void *bytes, size_t count)
{
    fold(h->run, bytes, count);
}

void run_hash_fold_doubles(struct run_hash *h, const double values[], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        fold_double(h->run, values[i]);
    }
}

void run_hash_fold_number(struct run_hash *h, uint64_t number)
{
    fold_number(h->run, number);
}

void run_hash_order(struct run_hash *h, const muster_RunCommand *order)
{
    const double numbers[] = {order->x_m,       order->y_m,       order->heading_rad,
                              order->force_x_n, order->force_y_n, order->torque_nm,
                              order->time_s};
    fold_number(h->run, (uint64_t)order->order);
    fold_text(h->run, order->name);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        fold_double(h->run, numbers[i]);
    }
    fold_number(h->run, order->keeps_heading);
    fold_number(h->run, order->senses);
    fold_number(h->run, order->on);
}

void run_hash_outside(struct run_hash *h, const muster_Mail *mails, uint32_t count,
                      unsigned char digest[RUN_HASH_BYTES])
{
    MU_ASSERT(EVP_DigestInit_ex2(h->act, h->sha256, NULL) == 1);
    for (uint32_t i = 0; i < count; i++) {
        fold_mail(h->act, &mails[i]);
    }
    MU_ASSERT(EVP_DigestFinal_ex(h->act, digest, NULL) == 1);
}

uint64_t run_hash_peek(struct run_hash *h)
{
    unsigned char digest[RUN_HASH_BYTES];
    uint64_t bits = 0;
    MU_ASSERT(EVP_MD_CTX_copy_ex(h->act, h->run) == 1);
    MU_ASSERT(EVP_DigestFinal_ex(h->act, digest, NULL) == 1);
    for (size_t i = 0; i < sizeof bits; i++) {
        bits = bits << 8 | digest[i];
    }
    return bits;
}

void run_hash_end(struct run_hash *h, char text[RUN_HASH_TEXT])
{
    unsigned char digest[RUN_HASH_BYTES];
    MU_ASSERT(EVP_DigestFinal_ex(h->run, digest, NULL) == 1);
    for (size_t i = 0; i < RUN_HASH_BYTES; i++) {
        snprintf(text + 2 * i, 3, "%02x", digest[i]);
    }
}
