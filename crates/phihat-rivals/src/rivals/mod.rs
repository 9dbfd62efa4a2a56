//! The rivals, one file each.

use crate::rival::Entry;

mod adaptive_l1;
mod adrc;
mod chen_lee_feng;
mod computed_torque;
mod computed_torque_integral;
mod disturbance_observer;
mod effort_pid;
mod enhanced_time_delay;
mod fat;
mod fat_lumped;
mod feedforward_pd;
mod filtered_regressor;
mod finite_time;
mod franka_ros;
mod funnel;
mod fuzzy;
mod h_infinity_pid;
mod hayat_buss_2016;
mod incremental;
mod industrial_pid;
mod inverse_dynamics_qp;
mod makers_stack;
mod momentum_observer;
mod nonlinear_feedback;
mod nric;
mod orbital;
mod output_feedback;
mod park_chung;
mod pd;
mod pd_gravity;
mod pd_plus;
mod positions;
mod prescribed_performance;
mod proposed;
mod proposed_designed;
mod robust;
mod slotine_li;
mod suboptimal;
mod super_twisting;
mod switching;
mod task_space;
mod taylor_network;
mod time_delay;
mod ultra_local;
mod yang;

/// Every rival: plain laws, the rows of the paper's Table 1 in its order, other laws, the paper's own, its
/// last row, and this project's law from positions.
/// One line each.
pub const RIVALS: &[Entry] = &[
    Entry::of::<pd::Pd>(),
    Entry::of::<pd_gravity::PdGravity>(),
    Entry::of::<pd_plus::PdPlus>(),
    Entry::of::<feedforward_pd::FeedforwardPd>(),
    Entry::of::<makers_stack::MakersStack>(),
    Entry::of::<franka_ros::FrankaRos>(),
    Entry::of::<effort_pid::EffortPid>(),
    Entry::of::<computed_torque::ComputedTorque>(),
    Entry::of::<computed_torque_integral::ComputedTorqueIntegral>(),
    Entry::of::<momentum_observer::MomentumObserver>(),
    Entry::of::<inverse_dynamics_qp::InverseDynamicsQp>(),
    Entry::of::<slotine_li::SlotineLi>(),
    Entry::of::<slotine_li::ByUnit>(),
    Entry::of::<fat_lumped::FatLumped>(),
    Entry::of::<robust::Robust>(),
    Entry::of::<task_space::TaskSpace>(),
    Entry::of::<output_feedback::OutputFeedback>(),
    Entry::of::<nonlinear_feedback::NonlinearFeedback>(),
    Entry::of::<filtered_regressor::FilteredRegressor>(),
    Entry::of::<yang::Yang>(),
    Entry::of::<switching::Switching>(),
    Entry::of::<finite_time::FiniteTime>(),
    Entry::of::<orbital::Orbital>(),
    Entry::of::<nric::Nric>(),
    Entry::of::<h_infinity_pid::HInfinityPid>(),
    Entry::of::<fat::Fat>(),
    Entry::of::<taylor_network::TaylorNetwork>(),
    Entry::of::<fuzzy::Fuzzy>(),
    Entry::of::<ultra_local::UltraLocal>(),
    Entry::of::<park_chung::ParkChung>(),
    Entry::of::<chen_lee_feng::ChenLeeFeng>(),
    Entry::of::<industrial_pid::IndustrialPid>(),
    Entry::of::<disturbance_observer::DisturbanceObserver>(),
    Entry::of::<adrc::Adrc>(),
    Entry::of::<super_twisting::SuperTwisting>(),
    Entry::of::<suboptimal::Suboptimal>(),
    Entry::of::<funnel::Hackl>(),
    Entry::of::<funnel::Berger>(),
    Entry::of::<time_delay::TimeDelay>(),
    Entry::of::<enhanced_time_delay::EnhancedTimeDelay>(),
    Entry::of::<incremental::Incremental>(),
    Entry::of::<adaptive_l1::AdaptiveL1>(),
    Entry::of::<prescribed_performance::PrescribedPerformance>(),
    Entry::of::<hayat_buss_2016::HayatBuss2016>(),
    Entry::of::<proposed::ProposedFirst>(),
    Entry::of::<proposed::Second>(),
    Entry::of::<proposed_designed::ProposedDesigned>(),
    Entry::of::<positions::PositionsRow<positions::PositionsFirst>>(),
    Entry::of::<positions::PositionsRow<positions::PositionsSecond>>(),
    Entry::of::<positions::PositionsRow<positions::ByDesign>>(),
    Entry::of::<positions::PositionsRow<positions::PositionsFiltered>>(),
];

pub use positions::position_law;

/// PID with feed-forward, by itself: a program that has no other rival need not carry [`RIVALS`].
pub const INDUSTRIAL_PID: Entry = Entry::of::<industrial_pid::IndustrialPid>();

/// The rival of an id.
pub fn rival(id: &str) -> Option<&'static Entry> {
    RIVALS.iter().find(|entry| entry.card.id == id)
}
