; SPDX-License-Identifier: Apache-2.0
;
; The thrifty shop of examples/kinds.c in rules: a shop, but what comes in bulk is cheaper, and it does
; not let itself be disposed of.
(extends "kinds_shop.clp")

(deffunction thrifty (?id ?from ?performative ?content)
  (if (and (eq ?performative cfp) (> (length$ ?content) 0)) then
    (reply-as ?id propose price 7)
   else FALSE))

(deffunction stay (?id ?from ?performative ?content)
  (if (eq ?performative dispose) then (reply-as ?id refuse dispose) else FALSE))

(on-layer 4 thrifty)
(on-layer 1 stay)
