//! `--display-server`: what a viewer is sent is the picture, and a viewer that is not there or goes away costs
//! nothing but a warning.
//!
//! The viewer is a socket of this test, which knows tev's packets by itself.

#![allow(missing_docs)]

mod program;

use std::{
    collections::BTreeMap,
    fs,
    io::{self, Read},
    net::{TcpListener, TcpStream},
    thread,
};

use exr::prelude::read_all_flat_layers_from_file;
use program::{fails, folder, packlight, path, stderr};

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.xml");

/// Bytes of a packet, little-endian, read from the front.
struct Packet<'b>(&'b [u8]);

impl Packet<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_first_chunk().expect("a packet is as long as it says");
        self.0 = rest;
        *head
    }

    fn u8(&mut self) -> u8 {
        self.take::<1>()[0]
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|&byte| byte == 0).expect("texts end with a zero");
        let text = String::from_utf8(self.0[..end].into()).expect("texts are UTF-8");
        self.0 = &self.0[end + 1..];
        text
    }

    fn texts(&mut self) -> Vec<String> {
        (0..self.u32()).map(|_| self.text()).collect()
    }
}

/// What a viewer shows.
#[derive(Default)]
struct Shown {
    name: String,
    width: usize,
    height: usize,
    planes: BTreeMap<String, Vec<f32>>,
    updates: usize,
}

impl Shown {
    /// Everything that comes, until the other end is closed.
    fn of(mut stream: TcpStream) -> io::Result<Self> {
        let mut shown = Self::default();
        let mut length = [0; 4];
        while stream.read_exact(&mut length).is_ok() {
            // The length counts itself.
            let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
            stream.read_exact(&mut bytes)?;
            shown.take(Packet(&bytes));
        }
        Ok(shown)
    }

    fn take(&mut self, mut packet: Packet<'_>) {
        let (kind, _focus, name) = (packet.u8(), packet.u8(), packet.text());
        match kind {
            4 => {
                (self.name, self.width, self.height) = (name, packet.u32() as usize, packet.u32() as usize);
                let blank = vec![0.0; self.width * self.height];
                self.planes = packet.texts().into_iter().map(|channel| (channel, blank.clone())).collect();
            }
            6 => {
                assert_eq!(name, self.name);
                self.update(packet);
            }
            _ => panic!("there is no need for a packet of kind {kind}"),
        }
        assert!(self.width > 0, "the first packet is the picture's");
    }

    fn update(&mut self, mut packet: Packet<'_>) {
        let channels = packet.texts();
        let [x, y, width, height] = std::array::from_fn(|_| packet.u32() as usize);
        let mut numbers = || -> Vec<usize> { channels.iter().map(|_| packet.u64() as usize).collect() };
        let (offsets, strides) = (numbers(), numbers());
        let data: Vec<f32> =
            packet.0.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        for (channel, (offset, stride)) in channels.iter().zip(offsets.iter().zip(&strides)) {
            let plane = self.planes.get_mut(channel).expect("a channel that was announced");
            for i in 0..width * height {
                plane[(y + i / width) * self.width + x + i % width] = data[offset + i * stride];
            }
        }
        self.updates += 1;
    }
}

#[test]
fn a_viewer_has_the_picture_to_the_bit() {
    let folder = folder("display/bits");
    let crop = ["--crop", "7,97,3,70"];
    for (case, more) in [&[][..], &crop, &["--target-error", "0.2"], &["--shard", "1/1"]].iter().enumerate() {
        let listener = TcpListener::bind("localhost:0").expect("a port is free");
        let server = listener.local_addr().expect("it has one").to_string();
        let viewer = thread::spawn(move || Shown::of(listener.accept()?.0));
        let out = path(&folder, &format!("{case}.exr"));
        let words =
            ["render", SCENE, "-o", &out, "--quiet", "--width", "100", "--height", "80", "--spp", "90"];
        let layers = ["--aov", "albedo,normal,depth", "--threads", "2", "--display-server", &server];
        let output = packlight(&[&words[..], &layers, more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert_eq!(stderr(&output), "");
        let shown = viewer.join().expect("it understood").expect("it was sent whole packets");
        let image = read_all_flat_layers_from_file(&out).expect("it was written");
        let layer = &image.layer_data[0];
        assert_eq!(shown.name, out);
        assert_eq!((shown.width, shown.height), (layer.size.width(), layer.size.height()));
        assert_eq!(shown.planes.len(), 10);
        for channel in &layer.channel_data.list {
            let bits = |samples: &mut dyn Iterator<Item = f32>| samples.map(f32::to_bits).collect::<Vec<_>>();
            let sent = &shown.planes[&channel.name.to_string()];
            let written = bits(&mut channel.sample_data.values_as_f32());
            assert!(bits(&mut sent.iter().copied()) == written, "{more:?}: {}", channel.name);
        }
        // Twelve tiles, and nine of the crop; more than once, if there was time for it.
        assert!(shown.updates >= 9, "{}", shown.updates);
    }
}

#[test]
fn without_a_viewer_there_is_a_warning_and_the_same_picture() {
    let folder = folder("display/nobody");
    let (alone, out) = (path(&folder, "alone.exr"), path(&folder, "out.exr"));
    let words = ["render", SCENE, "--quiet", "--width", "40", "--spp", "2", "-o"];
    assert_eq!(packlight(&[&words[..], &[&alone]].concat()).status.code(), Some(0));
    let alone = fs::read(&alone).expect("it was written");
    // A port that was free a moment ago, and one where somebody hangs up.
    let listener = TcpListener::bind("localhost:0").expect("a port is free");
    let closed = listener.local_addr().expect("it has one").to_string();
    drop(listener);
    let output = packlight(&[&words[..], &[&out, "--display-server", &closed]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let warning = format!("warning: no display server at {closed} (");
    assert!(stderr(&output).starts_with(&warning), "{}", stderr(&output));
    assert!(fs::read(&out).expect("it was written") == alone);

    let listener = TcpListener::bind("localhost:0").expect("a port is free");
    let rude = listener.local_addr().expect("it has one").to_string();
    let viewer = thread::spawn(move || drop(listener.accept()));
    let output = packlight(&[&words[..], &[&out, "--display-server", &rude]].concat());
    viewer.join().expect("it hung up");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).lines().count() <= 1, "{}", stderr(&output));
    assert!(fs::read(&out).expect("it was written") == alone);
}

#[test]
fn what_is_no_address_is_2() {
    for wrong in ["localhost", "localhost:0", ":14158"] {
        fails(&["render", SCENE, "-o", "a.exr", "--display-server", wrong], 2, "localhost:14158");
    }
}
