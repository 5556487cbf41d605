//! Particle files: every format gives back what a writer put in, bit for bit; wrong files give an
//! error with a place; hostile ones, and hostile pictures, neither panic nor take memory that they do not justify.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

#[path = "support/fuzz.rs"]
mod fuzz;
#[path = "formats/hostile.rs"]
mod hostile;
#[path = "formats/oracle.rs"]
mod oracle;
#[path = "formats/pictures.rs"]
mod pictures;
#[path = "formats/shared.rs"]
mod shared;
#[path = "formats/sums.rs"]
mod sums;
#[path = "formats/writers.rs"]
mod writers;
#[path = "formats/wrong.rs"]
mod wrong;

use std::path::Path;

use glam::DVec3;
use meniscus::scene::particles::{
    Kind, ParticleSet, ReadError, Taken, Values, estimate_radius, known_extension, read, read_as,
};
use meniscus::scene::placement::{Placement, Up};
use writers::{Legacy, Mode, Order, Packing, Rows, Sample, Store, Xml};

fn parse(name: &str, bytes: &[u8]) -> Result<ParticleSet, ReadError> {
    read(Path::new(name), bytes)
}

/// The bits of `f32` triples, which tell -0 from 0.
fn bits(rows: &[[f32; 3]]) -> Vec<u32> {
    rows.as_flattened().iter().map(|v| v.to_bits()).collect()
}

fn f32_bits(values: &Values) -> Vec<u32> {
    match values {
        Values::F32(v) => v.iter().map(|v| v.to_bits()).collect(),
        other => panic!("expected f32, found {}", other.kind().name()),
    }
}

#[track_caller]
fn expect_position(set: &ParticleSet, sample: &Sample, kind: Kind) {
    assert_eq!(set.attributes[0].name, "position");
    assert_eq!(set.attributes[0].components, 3);
    assert_eq!(set.attributes[0].values.kind(), kind);
    assert_eq!((set.count, set.dropped), (sample.len(), 0));
    assert_eq!(bits(&set.positions()), bits(&sample.position));
}

#[track_caller]
fn expect(set: &ParticleSet, name: &str, components: usize, values: &Values) {
    let attribute = set.attribute(name).unwrap_or_else(|| panic!("no attribute `{name}`: {set:?}"));
    assert_eq!(attribute.components, components, "{name}");
    match (&attribute.values, values) {
        (Values::F32(_), Values::F32(_)) => assert_eq!(f32_bits(&attribute.values), f32_bits(values), "{name}"),
        (found, expected) => assert_eq!(found, expected, "{name}"),
    }
}

fn velocity(sample: &Sample) -> Values {
    Values::F32(sample.velocity.as_flattened().to_vec())
}

/// Counts around the sizes of pages and blocks that the writers use.
const COUNTS: [usize; 6] = [1, 2, 7, 16, 17, 100];

#[test]
fn legacy_vtk_gives_back_what_was_written() {
    for count in COUNTS {
        let sample = Sample::new(count);
        for flags in 0..8 {
            let how = Legacy { binary: flags & 1 != 0, five: flags & 2 != 0, poly: flags & 4 != 0 };
            let set = parse("a.vtk", &writers::legacy_vtk(&sample, how)).unwrap_or_else(|e| panic!("{how:?}: {e}"));
            expect_position(&set, &sample, Kind::F32);
            expect(&set, "id", 1, &Values::I32(sample.id.clone()));
            expect(&set, "velocity", 3, &velocity(&sample));
            expect(&set, "the mass", 1, &Values::F64(sample.mass.clone()));
            expect(&set, "wide", 1, &Values::I64(sample.id.iter().map(|&i| i64::from(i) << 20).collect()));
            assert_eq!(set.attributes.len(), 5, "cell data is no point data");
            assert_eq!(set.radius, Some(0.025));
        }
    }
}

#[test]
fn legacy_vtk_reads_every_kind_of_array() {
    let text = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n1 2 3\n4 5 6\nPOINT_DATA 2\n\
        COLOR_SCALARS tint 2\n0 0.5\n1 0.25\nNORMALS n float\n0 0 1\n0 1 0\nTEXTURE_COORDINATES uv 2 float\n0 1\n1 0\n\
        TENSORS6 s float\n1 2 3 4 5 6\n1 2 3 4 5 6\nTENSORS t float\n1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9\n\
        GLOBAL_IDS g vtkIdType\n7 8\nSCALARS flag bit 1\nLOOKUP_TABLE default\n1 0\n\
        FIELD f 2\nwords 1 2 string\nfirst word\nsecond\nsmall 1 2 unsigned_char\n255 0\n";
    let set = parse("a.vtk", text.as_bytes()).unwrap();
    assert_eq!(set.attributes[0].values, Values::F64(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    expect(&set, "tint", 2, &Values::F32(vec![0.0, 0.5, 1.0, 0.25]));
    expect(&set, "n", 3, &Values::F32(vec![0.0, 0.0, 1.0, 0.0, 1.0, 0.0]));
    expect(&set, "uv", 2, &Values::F32(vec![0.0, 1.0, 1.0, 0.0]));
    assert_eq!(set.attribute("s").map(|a| a.components), Some(6));
    assert_eq!(set.attribute("t").map(|a| a.components), Some(9));
    expect(&set, "g", 1, &Values::I32(vec![7, 8]));
    expect(&set, "flag", 1, &Values::U8(vec![1, 0]));
    expect(&set, "small", 1, &Values::U8(vec![255, 0]));
    assert_eq!(set.notes, ["attribute `words` is left out: it holds text"]);
    assert_eq!((set.min, set.max), ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]));
}

#[test]
fn legacy_vtk_reads_binary_bits_and_reads_over_binary_strings() {
    let mut bytes = b"# vtk DataFile Version 5.1\nt\nBINARY\nDATASET POLYDATA\nPOINTS 9 float\n".to_vec();
    bytes.extend([0; 9 * 12]);
    bytes.extend(b"\nPOINT_DATA 9\nFIELD f 3\nwords 1 2 string\n\xc2ab");
    bytes.extend([0x80, 70]);
    bytes.extend([b'x'; 70]);
    bytes.extend(b"\nflags 1 9 bit\n\xa0\x80\nlast 1 9 signed_char\n");
    bytes.extend([0xff; 9]);
    let set = parse("a.vtk", &bytes).unwrap();
    expect(&set, "flags", 1, &Values::U8(vec![1, 0, 1, 0, 0, 0, 0, 0, 1]));
    expect(&set, "last", 1, &Values::I8(vec![-1; 9]));
}

#[test]
fn xml_vtk_gives_back_what_was_written() {
    for count in COUNTS {
        let sample = Sample::new(count);
        for mode in [Mode::Text, Mode::Inline, Mode::AppendedRaw, Mode::AppendedBase64] {
            for flags in 0..24 {
                let how = Xml {
                    mode,
                    packing: [Packing::None, Packing::Zlib, Packing::Lz4][flags / 8],
                    wide: flags & 1 != 0,
                    order: if flags & 2 != 0 { Order::Big } else { Order::Little },
                    poly: flags & 4 != 0,
                };
                let name = if how.poly { "a.vtp" } else { "a.vtu" };
                let set = parse(name, &writers::xml_vtk(&sample, how)).unwrap_or_else(|e| panic!("{how:?}: {e}"));
                expect_position(&set, &sample, Kind::F32);
                expect(&set, "id", 1, &Values::I32(sample.id.clone()));
                expect(&set, "velocity", 3, &velocity(&sample));
                expect(&set, "the mass & more", 1, &Values::F64(sample.mass.clone()));
                assert_eq!(set.attributes.len(), 4);
                assert_eq!(set.radius, Some(0.025));
            }
        }
    }
}

#[test]
fn pieces_keep_only_attributes_that_all_have_alike() {
    let piece = |extra: &str| {
        format!(
            "<Piece NumberOfPoints=\"1\"><PointData><DataArray type=\"Int8\" Name=\"a\">7</DataArray>{extra}</PointData>\
             <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">1 2 3</DataArray></Points></Piece>"
        )
    };
    let extra = "<DataArray type=\"Int8\" Name=\"b\">1</DataArray>";
    let xml = format!(
        "<VTKFile type=\"PolyData\"><PolyData>{}{}</PolyData></VTKFile>",
        piece(extra),
        piece("<Array type=\"String\" Name=\"s\">49 0</Array>")
    );
    let set = parse("a.vtp", xml.as_bytes()).unwrap();
    assert_eq!(set.count, 2);
    expect(&set, "a", 1, &Values::I8(vec![7, 7]));
    assert!(set.attribute("b").is_none());
    assert_eq!(set.notes, ["attribute `b` is left out: not all pieces have it alike"]);
}

#[test]
fn ply_gives_back_what_was_written() {
    for count in COUNTS {
        let sample = Sample::new(count);
        for order in [None, Some(Order::Big), Some(Order::Little)] {
            let set = parse("a.ply", &writers::ply(&sample, order)).unwrap_or_else(|e| panic!("{order:?}: {e}"));
            expect_position(&set, &sample, Kind::F32);
            expect(&set, "id", 1, &Values::I32(sample.id.clone()));
            expect(&set, "color", 4, &Values::U8((0..count).flat_map(writers::color).collect()));
            expect(&set, "velocity", 3, &velocity(&sample));
            expect(&set, "mass", 1, &Values::F64(sample.mass.clone()));
            assert_eq!(set.attributes.len(), 5);
        }
    }
}

#[test]
fn ply_reads_over_lists_among_the_vertices() {
    let head = |format: &str| {
        format!(
            "ply\r\nformat {format} 1.0\r\nelement vertex 2\r\nproperty double x\r\nproperty double y\r\n\
             property list uint8 int16 near\r\nproperty double z\r\nproperty float32 nx\r\nproperty float32 ny\r\n\
             property float32 nz\r\nproperty ushort pscale\r\nend_header\r\n"
        )
    };
    let text = head("ascii") + "1 2 2 5 6 3 0 0 1 4\n4 5 0 6 0 1 0 4\n";
    let mut binary = head("binary_big_endian").into_bytes();
    for (xy, near, z, n) in
        [([1.0_f64, 2.0], vec![5_i16, 6], 3.0_f64, [0.0_f32, 0.0, 1.0]), ([4.0, 5.0], vec![], 6.0, [0.0, 1.0, 0.0])]
    {
        xy.iter().for_each(|v| binary.extend(v.to_be_bytes()));
        binary.push(near.len() as u8);
        near.iter().for_each(|v| binary.extend(v.to_be_bytes()));
        binary.extend(z.to_be_bytes());
        n.iter().for_each(|v| binary.extend(v.to_be_bytes()));
        binary.extend(4_u16.to_be_bytes());
    }
    for bytes in [text.as_bytes(), &binary] {
        let set = parse("a.ply", bytes).unwrap();
        assert_eq!(set.attributes[0].values, Values::F64(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        expect(&set, "normal", 3, &Values::F32(vec![0.0, 0.0, 1.0, 0.0, 1.0, 0.0]));
        assert_eq!(set.notes, ["property `near` is left out: it is a list"]);
        assert_eq!(set.radius, Some(4.0), "all have the same radius");
    }
}

const TEXTS: &str = "attribute `kind` holds text, which is given as numbers: 0 for `drop`, 1 for `bubble`";

#[test]
fn classic_bgeo_gives_back_what_was_written() {
    for count in COUNTS {
        let sample = Sample::new(count);
        let plain = writers::classic_bgeo(&sample);
        let packed = writers::gzip(&plain);
        for (name, bytes) in [("a.bgeo", &plain), ("a.bgeo", &packed), ("a.bgeo.gz", &packed), ("A.BGEO.GZ", &plain)] {
            let set = parse(name, bytes).unwrap();
            expect_position(&set, &sample, Kind::F32);
            expect(&set, "id", 1, &Values::I32(sample.id.clone()));
            expect(&set, "velocity", 3, &velocity(&sample));
            expect(&set, "kind", 1, &Values::I32(sample.kinds()));
            assert_eq!(set.attributes.len(), 4);
            assert_eq!(set.notes, [TEXTS]);
            assert_eq!(set.radius, Some(0.025));
        }
    }
}

#[test]
fn a_fault_behind_the_points_of_a_classic_bgeo_takes_no_points() {
    let sample = Sample::new(17);
    let good = writers::classic_bgeo(&sample);
    let name = good.windows(6).rposition(|w| w == b"pscale").unwrap();
    // The type of the detail attribute, and an end in the middle of its definition.
    let mut wrong = good.clone();
    wrong[name + 8..name + 12].copy_from_slice(&77_i32.to_be_bytes());
    for (bytes, why) in [(wrong, "expected type 0, 1, 4 or 5, found 77"), (good[..name + 9].to_vec(), "before the end")]
    {
        for bytes in [writers::gzip(&bytes), bytes] {
            let set = parse("a.bgeo", &bytes).unwrap();
            expect_position(&set, &sample, Kind::F32);
            expect(&set, "id", 1, &Values::I32(sample.id.clone()));
            let note = set.notes.last().unwrap();
            assert!(note.starts_with("what follows the points is left out: byte ") && note.contains(why), "{note}");
            assert_eq!(set.radius, None);
        }
    }
}

#[test]
fn json_bgeo_gives_back_what_was_written() {
    for count in COUNTS {
        let mut sample = Sample::new(count);
        // Pages in which a pack has one value.
        for (row, position) in sample.position.iter_mut().enumerate().filter(|(row, _)| row / 4 % 2 == 0) {
            position[0] = 0.5;
            position[2] = if row < 8 { position[2] } else { -0.0 };
        }
        for store in [Store::Pages, Store::Packs, Store::Tuples] {
            for order in [Order::Little, Order::Big] {
                let bytes = writers::json_bgeo(&sample, store, order);
                for bytes in [writers::gzip(&bytes), bytes] {
                    let set = parse("a.bgeo", &bytes).unwrap_or_else(|e| panic!("{store:?} {order:?}: {e}"));
                    expect_position(&set, &sample, Kind::F32);
                    expect(&set, "id", 1, &Values::I32(sample.id.clone()));
                    expect(&set, "v", 3, &velocity(&sample));
                    expect(&set, "kind", 1, &Values::I32(sample.kinds()));
                    assert_eq!(set.notes, [TEXTS]);
                    assert_eq!(set.radius, Some(0.025));
                }
            }
        }
    }
}

#[test]
fn xyz_and_csv_give_back_what_was_written() {
    for count in COUNTS {
        let sample = Sample::new(count);
        expect_position(&parse("a.xyz", &writers::xyz(&sample)).unwrap(), &sample, Kind::F32);
        expect_position(&parse("a.xyz", &writers::xyz_text(&sample)).unwrap(), &sample, Kind::F64);

        let set = parse("a.csv", &writers::csv(&sample)).unwrap();
        assert_eq!(set.attributes[0].values.kind(), Kind::F64);
        assert_eq!(bits(&set.positions()), bits(&sample.position));
        expect(&set, "id", 1, &Values::I32(sample.id.clone()));
        expect(&set, "the \"mass\"", 1, &Values::F64(sample.mass.clone()));
        let found = set.attribute("velocity").unwrap();
        assert_eq!(found.components, 3);
        let found: Vec<u32> = found.to_f32().iter().map(|v| v.to_bits()).collect();
        assert_eq!(found, bits(&sample.velocity));
        assert_eq!(set.notes, ["column `name` is left out: it holds text"]);
    }
}

#[test]
fn json_gives_back_what_was_written() {
    for count in COUNTS {
        let sample = Sample::new(count);
        for rows in [Rows::Bare, Rows::Objects, Rows::Columns, Rows::Flat] {
            let set = parse("a.json", &writers::json(&sample, rows)).unwrap_or_else(|e| panic!("{rows:?}: {e}"));
            expect_position(&set, &sample, Kind::F64);
            if rows == Rows::Bare {
                assert_eq!(set.attributes.len(), 1);
                continue;
            }
            expect(&set, "id", 1, &Values::I32(sample.id.clone()));
            expect(&set, "mass", 1, &Values::F64(sample.mass.clone()));
            let found = set.attribute("velocity").unwrap();
            assert_eq!(found.components, 3, "{rows:?}");
            let found: Vec<u32> = found.to_f32().iter().map(|v| v.to_bits()).collect();
            assert_eq!(found, bits(&sample.velocity), "{rows:?}");
            assert_eq!(set.attributes.len(), 4, "{rows:?}");
            let (radius, notes): (_, &[&str]) = match rows {
                Rows::Objects => (None, &["`name` is left out: it holds text"]),
                _ => (Some(0.025), &[]),
            };
            assert_eq!((set.radius, set.notes.iter().map(String::as_str).collect()), (radius, notes.to_vec()));
        }
    }
    let nested = br#"[{"p": {"x": 1, "y": 2, "z": 3}, "on": true}, {"p": {"x": 4, "y": 5, "z": null}, "on": false}]"#;
    let set = parse("a.json", nested).unwrap();
    assert_eq!((set.positions().to_vec(), set.dropped), (vec![[1.0, 2.0, 3.0]], 1), "{set:?}");
    assert_eq!(parse("a.json", b"[]").unwrap().count, 0);
}

#[test]
fn pdb_and_ptc_give_back_what_was_written() {
    for count in COUNTS {
        let sample = Sample::new(count);
        for flags in 0..8 {
            let order = if flags & 1 != 0 { Order::Big } else { Order::Little };
            let bytes = writers::pdb(&sample, flags & 2 != 0, order);
            let bytes = if flags & 4 != 0 { writers::gzip(&bytes) } else { bytes };
            let set = parse("a.pdb", &bytes).unwrap_or_else(|e| panic!("{count} {flags}: {e}"));
            expect_position(&set, &sample, Kind::F32);
            expect(&set, "id", 1, &Values::I32(sample.id.clone()));
            expect(&set, "velocity", 3, &velocity(&sample));
        }
        for version in 0..3 {
            let set = parse("a.ptc", &writers::ptc(&sample, version)).unwrap_or_else(|e| panic!("{version}: {e}"));
            expect_position(&set, &sample, Kind::F32);
            expect(&set, "velocity", 3, &velocity(&sample));
            assert_eq!(set.radius, Some(0.025));
            let normal = set.attribute("normal").unwrap().to_f32();
            assert!(
                (normal[0] - 1.0).abs() < 1.0e-4 && normal[1].abs() < 1.0e-4 && normal[2].abs() < 1.0e-4,
                "{normal:?}"
            );
            assert!(normal.get(3..6).is_none_or(|none| none == [0.0; 3]));
        }
    }
}

#[test]
fn csv_takes_the_spellings_of_several_writers() {
    let with = |header: &str| format!("{header}\n1,2,3,9\n4,5,6,8\n");
    let headers = [
        "x,y,z,a",
        "X, Y, Z, a",
        "position_x,position_y,position_z,a",
        "Position:0,Position:1,Position:2,a",
        "Points_0,Points_1,Points_2,a",
        "\"Points:0\",\"Points:1\",\"Points:2\",\"a\"",
        "P[x],P[y],P[z],a",
        "P.x,P.y,P.z,a",
        "pos (x),pos (y),pos (z),a",
    ];
    for header in headers {
        for text in [with(header), with(header).replace(',', ";"), with(header).replace(',', "\t")] {
            let set = parse("a.csv", text.as_bytes()).unwrap_or_else(|e| panic!("{header}: {e}"));
            assert_eq!(*set.positions(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{header}");
            expect(&set, "a", 1, &Values::I32(vec![9, 8]));
        }
    }
    let bare = parse("a.csv", b"1,2,3\n4,5,6\n").unwrap();
    assert_eq!(bare.count, 2);
    assert_eq!(bare.notes, ["there is no header line; the three columns are taken as x, y and z"]);
}

/// What `PartVTK -savecsv` of DualSPHysics writes.
const PART_VTK: &str = "TimeStep [s];Np;Nbound;Nfixed;Nmoving;Nfloat;Nfluid\n0.05;2;0;0;0;0;2\n\n\
    Pos.x [m];Pos.y [m];Pos.z [m];Idp;Vel.x [m/s];Vel.y [m/s];Vel.z [m/s];Rhop [kg/m^3];Type;\n\
    1;2;3;7;0.5;0;0;1000;3;\n4;5;6;8;0.25;0;1;1001;3;\n";

#[test]
fn csv_reads_over_what_stands_before_the_header() {
    for text in [PART_VTK.to_owned(), PART_VTK.replace(';', ","), format!("# of a run\n{PART_VTK}")] {
        let set = parse("a.csv", text.as_bytes()).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(*set.positions(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        expect(&set, "Idp", 1, &Values::I32(vec![7, 8]));
        expect(&set, "Vel", 3, &Values::F64(vec![0.5, 0.0, 0.0, 0.25, 0.0, 1.0]));
        expect(&set, "Rhop", 1, &Values::I32(vec![1000, 1001]));
        assert_eq!(set.attributes.len(), 5, "{:?}", set.attributes);
        let line = text.lines().position(|line| line.starts_with("Pos.x")).unwrap() + 1;
        assert_eq!(set.notes, [format!("what stands before the header in line {line} is left out")]);
    }
}

#[test]
fn csv_takes_separators_at_the_end_and_spaces_between() {
    for text in ["x,y,z,id\n1,2,3,9,\n4,5,6,8,\n", "x;y;z;id;\n1;2;3;9\n4;5;6;8;\n", "x y  z id\n 1 2 3 9\n4  5 6 8 \n"]
    {
        let set = parse("a.csv", text.as_bytes()).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(*set.positions(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{text}");
        expect(&set, "id", 1, &Values::I32(vec![9, 8]));
        assert!(set.notes.is_empty(), "{:?}", set.notes);
    }
    // An empty cell that the header names is one.
    let set = parse("a.csv", b"x,y,z,a\n1,2,3,\n4,5,6,7\n").unwrap();
    assert!(set.attribute("a").unwrap().to_f32()[0].is_nan());
    // A unit goes from a name unless two names would be the same.
    let set = parse("a.csv", b"x,y,z,p [Pa],q [m],q [s]\n1,2,3,4,5,6\n").unwrap();
    for (name, value) in [("p", 4), ("q [m]", 5), ("q [s]", 6)] {
        expect(&set, name, 1, &Values::I32(vec![value]));
    }
}

#[test]
fn texts_may_begin_with_a_mark_and_have_letters_beyond_ascii() {
    let sample = Sample::new(7);
    let text = Legacy { binary: false, five: true, poly: false };
    let xml = Xml { mode: Mode::Text, packing: Packing::None, wide: false, order: Order::Little, poly: false };
    let csv = writers::csv(&sample);
    let csv = csv.strip_prefix(b"\xef\xbb\xbf").unwrap();
    let files = [
        ("a.xyz", writers::xyz_text(&sample)),
        ("a.csv", csv.to_vec()),
        ("a.csv", [b"# a comment\n", csv].concat()),
        ("a.json", writers::json(&sample, Rows::Columns)),
        ("a.ply", writers::ply(&sample, None)),
        ("a.vtk", writers::legacy_vtk(&sample, text)),
        ("a.vtu", writers::xml_vtk(&sample, xml)),
        ("a.vtu", writers::xml_vtk(&sample, Xml { mode: Mode::AppendedRaw, packing: Packing::Zlib, ..xml })),
    ];
    for (name, bytes) in files {
        let plain = parse(name, &bytes).unwrap();
        let marked = [b"\xef\xbb\xbf".to_vec(), bytes].concat();
        assert_eq!(parse(name, &marked).unwrap_or_else(|e| panic!("{name}: {e}")), plain, "{name}");
    }
    // Whatever their length, of which raw numbers make something if it is a multiple of 12.
    for comment in ["# größe".as_bytes(), b"# gr\xf6\xdfe", "# 水の粒".as_bytes()] {
        for length in 0..12 {
            let rows = [comment, &vec![b'.'; length], b"\n1 2 3\n4 5 6\n"].concat();
            let set = parse("a.xyz", &rows).unwrap();
            assert_eq!(*set.positions(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{}", String::from_utf8_lossy(comment));
        }
    }
    // A letter across the end of what is looked at.
    let long = [b"# ".to_vec(), "ß".repeat(5000).into_bytes(), b"\n1 2 3\n".to_vec()].concat();
    assert_eq!(parse("a.xyz", &long).unwrap().count, 1);
    assert_eq!(parse("a.xyz", &[&b" "[..], &long].concat()).unwrap().count, 1);
}

#[test]
fn csv_columns_are_as_wide_as_their_numbers() {
    let text =
        "x,y,z,i,u,l,h,f,v:0,v:1\n0,0,0,-1,4294967295,-4294967296,18446744073709551615,1,2,3\n0,0,0,1,0,0,0,,4,5.5\n";
    let set = parse("a.csv", text.as_bytes()).unwrap();
    expect(&set, "i", 1, &Values::I32(vec![-1, 1]));
    expect(&set, "u", 1, &Values::U32(vec![u32::MAX, 0]));
    expect(&set, "l", 1, &Values::I64(vec![-4_294_967_296, 0]));
    expect(&set, "h", 1, &Values::U64(vec![u64::MAX, 0]));
    expect(&set, "v", 2, &Values::F64(vec![2.0, 3.0, 4.0, 5.5]));
    let empty = set.attribute("f").unwrap().to_f32();
    assert!(empty[0] == 1.0 && empty[1].is_nan(), "an empty cell is not a number");
}

#[test]
fn rows_that_are_not_finite_go_from_all_attributes() {
    let mut sample = Sample::new(20);
    sample.position[0][1] = f32::NAN;
    sample.position[7][2] = f32::INFINITY;
    sample.position[19][0] = f32::NEG_INFINITY;
    let kept = |i: &usize| ![0, 7, 19].contains(i);
    let ids: Vec<i32> = (0..20).filter(kept).map(|i| sample.id[i]).collect();
    let velocities: Vec<f32> = (0..20).filter(kept).flat_map(|i| sample.velocity[i]).collect();
    let text = Legacy { binary: false, five: true, poly: false };
    let files = [
        ("a.bgeo", writers::classic_bgeo(&sample)),
        ("a.vtk", writers::legacy_vtk(&sample, text)),
        ("a.ply", writers::ply(&sample, None)),
        ("a.csv", writers::csv(&sample)),
    ];
    for (name, bytes) in files {
        let set = parse(name, &bytes).unwrap();
        assert_eq!((set.count, set.dropped), (17, 3), "{name}");
        assert_eq!(set.positions().len(), 17);
        expect(&set, "id", 1, &Values::I32(ids.clone()));
        assert_eq!(set.attribute("velocity").unwrap().to_f32(), velocities);
        assert!(set.min.iter().chain(&set.max).all(|v| v.is_finite()));
        let note = "dropped 3 of 20 particles whose position is not finite".to_owned();
        assert!(set.notes.contains(&note), "{name}: {:?}", set.notes);
    }
    let beyond = parse("a.csv", b"x,y,z\n1e300,0,0\n-nan(ind),1.#INF,0\n1,2,3\n").unwrap();
    assert_eq!((beyond.count, beyond.dropped), (1, 2), "what f32 cannot hold is not finite either");
}

#[test]
fn whole_files_without_particles_are_empty_sets_with_a_note() {
    let none = Sample::new(0);
    let raw = Xml { mode: Mode::AppendedRaw, packing: Packing::Zlib, wide: false, order: Order::Little, poly: false };
    let files = [
        ("a.vtk", writers::legacy_vtk(&none, Legacy { binary: true, five: false, poly: false })),
        ("a.vtk", writers::legacy_vtk(&none, Legacy { binary: false, five: true, poly: true })),
        ("a.vtu", writers::xml_vtk(&none, raw)),
        ("a.vtu", writers::xml_vtk(&none, Xml { mode: Mode::Text, ..raw })),
        ("a.ply", writers::ply(&none, Some(Order::Little))),
        ("a.bgeo", writers::classic_bgeo(&none)),
        ("a.bgeo", writers::json_bgeo(&none, Store::Pages, Order::Little)),
        ("a.xyz", b"# nothing\n".to_vec()),
        ("a.csv", b"x,y,z,id\n".to_vec()),
    ];
    for (name, bytes) in files {
        let set = parse(name, &bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((set.count, set.dropped, set.min, set.max), (0, 0, [0.0; 3], [0.0; 3]), "{name}");
        assert_eq!(set.attributes[0].name, "position");
        assert!(set.notes.contains(&"the file has no particles".to_owned()), "{name}: {:?}", set.notes);
    }
}

#[test]
fn a_radius_must_be_one_for_all_and_a_length() {
    let file = |radii: [&str; 2]| format!("x,y,z,Particle Radius\n0,0,0,{}\n1,0,0,{}\n", radii[0], radii[1]);
    assert_eq!(parse("a.csv", file(["0.5", "0.5"]).as_bytes()).unwrap().radius, Some(0.5));
    for (radii, why) in [
        (["0.5", "0.6"], "differs"),
        (["0", "0"], "no radius"),
        (["-1", "-1"], "no radius"),
        (["inf", "inf"], "no radius"),
    ] {
        let set = parse("a.csv", file(radii).as_bytes()).unwrap();
        assert_eq!(set.radius, None, "{radii:?}");
        assert!(set.notes.iter().any(|n| n.contains(why)), "{radii:?}: {:?}", set.notes);
    }
}

#[test]
fn conversions_to_lanes_take_the_nearest_value() {
    let text = "x,y,z,f,big\n0,0,0,-1.5,-5000000000\n0,0,0,3e9,5000000000\n0,0,0,nan,7\n";
    let set = parse("a.csv", text.as_bytes()).unwrap();
    let float = set.attribute("f").unwrap();
    assert_eq!(float.to_i32(), [-1, i32::MAX, 0]);
    assert_eq!(float.to_u32(), [0, 3_000_000_000, 0]);
    let big = set.attribute("big").unwrap();
    assert_eq!(big.to_i32(), [i32::MIN, i32::MAX, 7]);
    assert_eq!(big.to_u32(), [0, u32::MAX, 7]);
    assert_eq!(big.to_f32(), [-5.0e9, 5.0e9, 7.0]);
}

#[test]
fn a_scene_turns_scales_moves_and_renames() {
    let sample = Sample::new(6);
    let how = Legacy { binary: true, five: true, poly: false };
    let bytes = writers::legacy_vtk(&sample, how);
    let plain = parse("a.vtk", &bytes).unwrap();
    assert_eq!(read_as(Path::new("a.vtk"), &bytes, &Taken::default()).unwrap(), plain, "nothing is rounded");

    let placement = Placement { position: DVec3::new(1.0, 2.0, 3.0), ..Placement::of_file(Up::Z, 0.5) };
    let names = vec![("speed".to_owned(), "velocity".to_owned()), ("mass".to_owned(), "the mass".to_owned())];
    let set = read_as(Path::new("a.vtk"), &bytes, &Taken { placement, names }).unwrap();
    let half = |v: [f32; 3]| [0.5 * f64::from(v[0]), 0.5 * f64::from(v[2]), -0.5 * f64::from(v[1])];
    for (row, found) in sample.position.iter().zip(set.positions().iter()) {
        let [x, y, z] = half(*row);
        assert_eq!(*found, [(1.0 + x) as f32, (2.0 + y) as f32, (3.0 + z) as f32]);
    }
    assert_eq!(set.radius, plain.radius.map(|radius| radius / 2.0));
    assert!(set.attribute("velocity").is_none());
    expect(&set, "mass", 1, &plain.attribute("the mass").unwrap().values);
    expect(&set, "id", 1, &Values::I32(sample.id.clone()));
    // Under a name of its own it is not known for a velocity.
    expect(&set, "speed", 3, &velocity(&sample));
    let names = vec![("density".to_owned(), "the mass".to_owned())];
    let set = read_as(Path::new("a.vtk"), &bytes, &Taken { placement, names }).unwrap();
    let turned: Vec<f32> = sample.velocity.iter().flat_map(|v| half(*v).map(|x| x as f32)).collect();
    assert_eq!(set.attribute("velocity").unwrap().to_f32(), turned);
    let lengths = |set: &ParticleSet| (0..3).map(|axis| set.max[axis] - set.min[axis]).collect::<Vec<_>>();
    let (before, after) = (lengths(&plain), lengths(&set));
    assert!((after[1] / before[2] - 0.5).abs() < 1e-5, "bounds are of what was placed: {before:?} {after:?}");
}

#[test]
fn lengths_and_directions_go_along_with_places() {
    let text =
        b"x,y,z,v_x,v_y,v_z,normal_x,normal_y,normal_z,pscale,color_x,color_y,color_z\n1,2,3,0,0,4,0,0,1,2,7,8,9\n";
    let taken = Taken { placement: Placement::of_file(Up::Z, 0.001), names: vec![] };
    let set = read_as(Path::new("a.csv"), text, &taken).unwrap();
    assert_eq!(*set.positions(), [[0.001, 0.003, -0.002]]);
    for (name, expected) in [("v", [0.0, 0.004, 0.0]), ("normal", [0.0, 1.0, 0.0]), ("color", [7.0, 8.0, 9.0])] {
        assert_eq!(set.attribute(name).unwrap().to_f32(), expected, "{name}");
    }
    assert_eq!((set.radius, set.attribute("pscale").unwrap().to_f32()), (Some(0.002), vec![0.002]));
    // What becomes too far for f32 goes, as what was too far in the file.
    let far = Taken { placement: Placement::of_file(Up::Y, 1e9), names: vec![] };
    let set = read_as(Path::new("a.csv"), b"x,y,z\n1e30,0,0\n1,2,3\n", &far).unwrap();
    assert_eq!((set.count, set.dropped), (1, 1));
}

#[test]
fn extensions_are_known_in_any_case() {
    for name in ["a.vtk", "a.VTU", "a.vtp", "a.ply", "a.bgeo", "a.Bgeo.Gz", "a.xyz", "dir.obj/a.csv"] {
        assert!(known_extension(Path::new(name)), "{name}");
    }
    assert!(known_extension(Path::new("a.pvd")), "to say what to name in its place");
    for name in ["a.obj", "a", "vtk", "a.vtk.gz", "", "a.vtk/", ".."] {
        assert_eq!(known_extension(Path::new(name)), name == "a.vtk/", "{name}");
    }
}

mod spacing {
    use super::estimate_radius;

    fn random(count: usize, seed: u64) -> Vec<[f32; 3]> {
        let mut random = super::fuzz::Random(seed);
        (0..count).map(|_| std::array::from_fn(|_| random.below(1 << 20) as f32 / 1024.0)).collect()
    }

    /// The same by comparing all with all: the 32nd nearest of each, or the nearest of a few.
    fn by_hand(points: &[[f32; 3]]) -> f64 {
        let squared = |a: &[f32; 3], b: &[f32; 3]| -> f64 {
            a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum()
        };
        let few = points.len() < 256;
        // A heap of more than 24 in one place is one neighbour.
        let heaped = |p: &[f32; 3]| points.iter().filter(|q| *q == p).count() > 24;
        let mut places: Vec<[f32; 3]> = points.iter().copied().filter(|p| !heaped(p)).collect();
        if let Some(heap) = points.iter().find(|p| heaped(p)) {
            places.push(*heap);
        }
        let ranked = |p: &[f32; 3]| {
            let mut all: Vec<f64> = places.iter().map(|q| squared(p, q)).filter(|d| *d > 0.0).collect();
            all.sort_by(f64::total_cmp);
            all.get(if few { 0 } else { 31 }).copied()
        };
        let mut all: Vec<f64> = points.iter().filter_map(ranked).collect();
        all.sort_by(f64::total_cmp);
        if few {
            return all[all.len() / 2].sqrt() / 2.0;
        }
        // 32 and a half of them share the ball.
        let volume = 4.0 / 3.0 * std::f64::consts::PI * all[all.len() / 20].sqrt().powi(3);
        (volume / 32.5).cbrt() / 2.0
    }

    #[test]
    fn agrees_with_comparing_all_with_all() {
        let mut flat = random(1500, 2);
        flat.iter_mut().for_each(|p| p[1] = 4.0);
        let mut line = random(700, 3);
        line.iter_mut().for_each(|p| *p = [p[0], p[0], 0.0]);
        let mut scattered = random(1000, 4);
        scattered.iter_mut().step_by(9).for_each(|p| *p = p.map(|v| v * 1.0e20));
        let mut twice = random(500, 5);
        twice.extend(twice.clone());
        let mut far = random(300, 6);
        far.extend(vec![[7.0, 7.0, 7.0]; 900]);
        for points in [random(2000, 1), random(200, 7), flat, line, scattered, twice, far] {
            let (found, expected) = (f64::from(estimate_radius(&points).unwrap()), by_hand(&points));
            assert!((found / expected - 1.0).abs() < 1.0e-6, "{found} {expected}");
        }
    }

    #[test]
    fn a_lattice_gives_half_its_spacing() {
        let axis = 0..40_u8;
        let points: Vec<[f32; 3]> = axis
            .clone()
            .flat_map(|x| {
                axis.clone().flat_map(move |y| (0..40_u8).map(move |z| [x, y, z].map(|v| f32::from(v) * 0.25)))
            })
            .collect();
        let radius = estimate_radius(&points).unwrap();
        assert!((radius / 0.125 - 1.0).abs() < 0.02, "{radius}");
    }

    #[test]
    fn there_is_none_without_two_places() {
        assert_eq!(estimate_radius(&[]), None);
        assert_eq!(estimate_radius(&[[1.0; 3]]), None);
        assert_eq!(estimate_radius(&vec![[1.0; 3]; 100_000]), None);
        assert_eq!(estimate_radius(&[[f32::NAN; 3], [0.0; 3], [0.0, -0.0, 0.0]]), None);
        let mut nearly = vec![[1.0; 3]; 100_000];
        nearly.push([1.0, 1.0, 2.0]);
        assert_eq!(estimate_radius(&nearly), Some(0.5));
        assert_eq!(estimate_radius(&[[0.0; 3], [1.0, 0.0, 0.0]]), Some(0.5));
        assert_eq!(estimate_radius(&[[f32::MAX; 3], [f32::MIN; 3]]), None, "a radius beyond f32 is none");
    }
}
