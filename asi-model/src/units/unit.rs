//! Units and the quantities they measure.

/// A unit of measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineeringUnit {
    /// The UNECE common code, as `H87`.
    pub code: &'static str,
    /// The symbol people read, as `°C`; for counts the name.
    pub display_name: &'static str,
    /// The name in the recommendation, as `degree Celsius`.
    pub description: &'static str,
    /// Quantity of the unit; only units of one quantity convert into each other.
    pub quantity: Quantity,
    /// `value in base unit = value * factor + offset`.
    pub(super) factor: f64,
    pub(super) offset: f64,
}

macro_rules! quantities {
    ($($name:ident),* $(,)?) => {
        /// Physical or counted quantities.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Quantity { $($name),* }

        impl Quantity {
            /// The quantity that the table of units calls so.
            pub(super) fn from_name(name: &str) -> Option<Self> {
                $(if name == stringify!($name) {
                    return Some(Self::$name);
                })*
                None
            }
        }
    };
}

quantities! {
    Length,
    Area,
    Volume,
    Mass,
    Time,
    Frequency,
    Angle,
    AngularVelocity,
    Velocity,
    Acceleration,
    Force,
    Torque,
    Pressure,
    Energy,
    Power,
    ApparentPower,
    ReactivePower,
    Current,
    Voltage,
    Resistance,
    Capacitance,
    Inductance,
    Charge,
    MagneticFlux,
    MagneticFluxDensity,
    Conductance,
    Temperature,
    Luminosity,
    Illuminance,
    LuminousFlux,
    VolumeFlow,
    MassFlow,
    DynamicViscosity,
    KinematicViscosity,
    Density,
    AreaDensity,
    Ratio,
    Count,
    Amount,
    Stiffness,
    DataAmount,
    Level,
    Acidity,
    Packaging,
    Other,
}
