/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file query.h
 * Questions to the white pages: mails to `broker`, answered by mail.
 *
 *   lookup NAME  ->  inform   member NAME KIND STATE BROKER HOST PID
 *                    failure  unknown-name NAME
 *   listing      ->  inform   members NAME NAME ...   (several mails if they do not fit one)
 *   anything     ->  not-understood
 */
#ifndef MUSTER_BROKER_QUERY_H
#define MUSTER_BROKER_QUERY_H

#include "broker/store.h"

struct broker;

void query_answer(struct broker *b, const struct mail *question);

/** Answers that this is not understood. */
void query_refuse(struct broker *b, uint32_t own, const struct mail *question);

/** Answers a mail; own is who was asked, performative is inform, failure or not-understood. */
void query_reply(struct broker *b, uint32_t own, const struct mail *question,
                 const char *performative, char *content);

#endif
