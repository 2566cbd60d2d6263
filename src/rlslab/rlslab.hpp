// One include for a first try: all dense variants, and what goes around a filter. A program that is built often
// includes the pages it uses.
#pragma once

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/adapt/delay_line.hpp>
#include <rlslab/adapt/excitation.hpp>
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/sample.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/core/rounding.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/many/fold_all.hpp>
#include <rlslab/many/rolling.hpp>
#include <rlslab/state/convert.hpp>
#include <rlslab/state/merge.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>
