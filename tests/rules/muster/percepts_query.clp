; SPDX-License-Identifier: Apache-2.0
; A query over facts, in what a rule does, is a look at the fact of the sonars.
(defrule look
  (position ?time $?)
  =>
  (printout t "seen " (any-factp ((?f sonar)) (= (nth$ 1 (fact-slot-value ?f implied)) ?time)) crlf))

; step: sonar=5000
; expect: seen TRUE
; step:
; expect: seen TRUE
