; SPDX-License-Identifier: Apache-2.0
(deffacts one (one))
(extends "circle2.clp")
