//! `--display-server`: the picture in a viewer while it is rendered.
//!
//! The viewer is tev, or whatever else listens as tev does. It is told the picture's size and channels, and
//! then, now and then, the tiles that have changed. Whatever it does, the render goes on.

use std::{
    io,
    net::{TcpStream, ToSocketAddrs},
    path::Path,
    time::{Duration, Instant},
};

use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use super::meanwhile::meanwhile;
use crate::{
    cli::failure::warn_of,
    render::{Frame, TileView},
};

/// From one look at the frame to the next, at least.
const PAUSE: Duration = Duration::from_millis(250);

/// A look may take this share of the time, as a divisor: what is shown should not be what is waited for.
const SHARE: u32 = 10;

/// Time in which a viewer must answer, or take what it is sent.
const PATIENCE: Duration = Duration::from_secs(5);

/// Where a viewer listens: `host:port`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Server(String);

/// For clap.
pub(super) fn parse(argument: &str) -> Result<Server, String> {
    match argument.rsplit_once(':').map(|(host, port)| (host, port.parse::<u16>())) {
        Some((host, Ok(1..))) if !host.is_empty() => Ok(Server(argument.to_owned())),
        _ => Err("expected host:port, as in --display-server localhost:14158, where tev listens".into()),
    }
}

/// Does `work`, and shows the frame, under a name, meanwhile and afterwards.
pub(super) fn showing(server: Option<&Server>, frame: &Frame, name: &Path, work: impl FnOnce()) {
    let Some(server) = server else { return work() };
    let warn = |what: &str, error: io::Error| {
        warn_of(format!("{what} {} ({error}); the render goes on without it", server.0));
    };
    let mut show = match Show::begin(server, frame, name.display().to_string()) {
        Ok(show) => Some(show),
        Err(error) => {
            warn("no display server at", error);
            None
        }
    };
    let mut update = || {
        let start = Instant::now();
        if let Some(Err(error)) = show.as_mut().map(Show::update) {
            warn("nothing more is shown by the display server at", error);
            show = None;
        }
        PAUSE.max(start.elapsed() * SHARE)
    };
    meanwhile(PAUSE, &mut update, work);
    update();
}

/// A frame, as a viewer has it.
struct Show<'f> {
    viewer: TevClient,
    frame: &'f Frame,
    name: String,
    /// Samples that each tile had when it was sent.
    seen: Vec<u32>,
}

impl<'f> Show<'f> {
    fn begin(server: &Server, frame: &'f Frame, name: String) -> io::Result<Self> {
        let mut viewer = TevClient::wrap(connect(server)?);
        let [width, height] = frame.size();
        viewer.send(PacketCreateImage {
            image_name: &name,
            grab_focus: true,
            width,
            height,
            channel_names: frame.channels(),
        })?;
        Ok(Self { viewer, frame, name, seen: vec![0; frame.tiles()] })
    }

    /// Sends every tile that has other samples than when it was sent.
    fn update(&mut self) -> io::Result<()> {
        for (tile, seen) in self.seen.iter_mut().enumerate() {
            let Some(TileView { x, y, samples, picture }) = self.frame.tile(tile, *seen) else { continue };
            let planes: Vec<&[f32]> =
                picture.channels.iter().map(|channel| channel.samples.as_slice()).collect();
            let pixels = u64::from(picture.width) * u64::from(picture.height);
            let offsets: Vec<u64> = (0..planes.len() as u64).map(|plane| plane * pixels).collect();
            self.viewer.send(PacketUpdateImage {
                image_name: &self.name,
                grab_focus: false,
                channel_names: self.frame.channels(),
                channel_offsets: &offsets,
                channel_strides: &vec![1; planes.len()],
                x,
                y,
                width: picture.width,
                height: picture.height,
                data: &planes.concat(),
            })?;
            *seen = samples;
        }
        Ok(())
    }
}

/// By the first of the host's addresses that answers.
fn connect(Server(address): &Server) -> io::Result<TcpStream> {
    let mut failed = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                return Ok(stream);
            }
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_is_a_host_and_a_port() {
        for right in ["localhost:14158", "10.0.0.7:1", "[::1]:65535"] {
            assert_eq!(parse(right), Ok(Server(right.into())));
        }
        for wrong in ["", "localhost", "localhost:", ":14158", "localhost:0", "localhost:99999", "a:b"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
