; SPDX-License-Identifier: Apache-2.0
; A shop: answers in layer 4, and takes every mail of it.
(deffunction shop-trade (?id ?from ?performative ?content)
  (printout t "shop " ?performative " " ?content crlf)
  (reply ?id price 10))

(on-layer 4 shop-trade)
