//! Settings of a port, and their text: `/dev/ttyUSB0,parity=even,stop=2`.

use std::{fmt, path::PathBuf, str::FromStr, time::Duration};

use serialport::{DataBits, FlowControl, SerialPortBuilder, StopBits};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    None,
    Even,
    Odd,
}

/// A port and its set-up: eight data bits, no flow control, and these settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialSettings {
    pub path: PathBuf,
    /// Bit rate, bits per second; A.1 has 9600.
    pub baud: u32,
    /// Parity (ASSUMED none; the appendix does not say).
    pub parity: Parity,
    /// Two stop bits instead of one (ASSUMED one; the appendix does not say).
    pub two_stop_bits: bool,
    /// Check CTS, if the port has it; off for cables with three wires.
    pub clear_to_send: bool,
}

impl SerialSettings {
    /// A port with 9600 baud, no parity, one stop bit, and CTS.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            baud: 9600,
            parity: Parity::None,
            two_stop_bits: false,
            clear_to_send: true,
        }
    }

    pub(super) fn builder(&self, name: &str) -> SerialPortBuilder {
        let parity = match self.parity {
            Parity::None => serialport::Parity::None,
            Parity::Even => serialport::Parity::Even,
            Parity::Odd => serialport::Parity::Odd,
        };
        serialport::new(name, self.baud)
            .data_bits(DataBits::Eight)
            .parity(parity)
            .stop_bits(if self.two_stop_bits { StopBits::Two } else { StopBits::One })
            .flow_control(FlowControl::None)
            .timeout(Duration::ZERO)
            // The robot reads it as its CTS (A.2).
            .dtr_on_open(true)
    }
}

impl FromStr for SerialSettings {
    type Err = String;

    /// `PATH[,baud=N][,parity=none|even|odd][,stop=1|2][,cts=watch|ignore]`
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut parts = text.split(',');
        let path = parts.next().filter(|path| !path.is_empty());
        let mut settings = Self::new(path.ok_or("the path of a port was expected, such as /dev/ttyUSB0")?);
        for part in parts {
            match part.split_once('=') {
                Some(("baud", baud)) => {
                    settings.baud =
                        baud.parse().ok().filter(|baud| (1..=4_000_000).contains(baud)).ok_or_else(|| {
                            format!("baud is a number of bits per second, such as 9600; found {baud}")
                        })?;
                }
                Some(("parity", "none")) => settings.parity = Parity::None,
                Some(("parity", "even")) => settings.parity = Parity::Even,
                Some(("parity", "odd")) => settings.parity = Parity::Odd,
                Some(("parity", other)) => return Err(format!("parity is none, even or odd; found {other}")),
                Some(("stop", "1")) => settings.two_stop_bits = false,
                Some(("stop", "2")) => settings.two_stop_bits = true,
                Some(("stop", other)) => return Err(format!("stop is 1 or 2; found {other}")),
                Some(("cts", "watch")) => settings.clear_to_send = true,
                Some(("cts", "ignore")) => settings.clear_to_send = false,
                Some(("cts", other)) => return Err(format!("cts is watch or ignore; found {other}")),
                _ => return Err(format!("baud=, parity=, stop= or cts= was expected; found {part}")),
            }
        }
        Ok(settings)
    }
}

impl fmt::Display for SerialSettings {
    /// Writes the notation of the command line, without the settings of [`SerialSettings::new`].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, baud, parity, two_stop_bits, clear_to_send } = self;
        let usual = Self::new(path);
        write!(f, "{}", path.display())?;
        if *baud != usual.baud {
            write!(f, ",baud={baud}")?;
        }
        f.write_str(match parity {
            Parity::None => "",
            Parity::Even => ",parity=even",
            Parity::Odd => ",parity=odd",
        })?;
        f.write_str(if *two_stop_bits { ",stop=2" } else { "" })?;
        f.write_str(if *clear_to_send { "" } else { ",cts=ignore" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_alone_has_the_set_up_of_the_appendix() {
        let settings: SerialSettings = "/dev/ttyS0".parse().unwrap();
        assert_eq!(settings, SerialSettings::new("/dev/ttyS0"));
        assert_eq!((settings.baud, settings.parity, settings.two_stop_bits), (9600, Parity::None, false));
    }

    #[test]
    fn options_follow_commas() {
        let settings: SerialSettings =
            "/dev/serial/by-id/usb-x:1,parity=odd,stop=2,baud=19200,cts=ignore".parse().unwrap();
        let expected = SerialSettings {
            path: "/dev/serial/by-id/usb-x:1".into(),
            baud: 19_200,
            parity: Parity::Odd,
            two_stop_bits: true,
            clear_to_send: false,
        };
        assert_eq!(settings, expected);
        assert_eq!(expected.to_string().parse(), Ok(expected));
        assert_eq!(SerialSettings::new("/dev/ttyS0").to_string(), "/dev/ttyS0");
    }

    #[test]
    fn mistakes_report_expected_and_found() {
        for (text, says) in [
            ("", "path of a port"),
            ("/dev/x,parity=mark", "none, even or odd; found mark"),
            ("/dev/x,stop=3", "1 or 2; found 3"),
            ("/dev/x,baud=fast", "found fast"),
            ("/dev/x,baud=0", "found 0"),
            ("/dev/x,cts", "found cts"),
            ("/dev/x,cts=maybe", "watch or ignore"),
            ("/dev/x,", "was expected; found "),
        ] {
            let error = text.parse::<SerialSettings>().expect_err(text);
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}
