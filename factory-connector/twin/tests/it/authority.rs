//! A certificate authority for tests.

/// A certificate authority of the plant.
pub struct Authority {
    pub issuer: rcgen::Issuer<'static, rcgen::KeyPair>,
    /// Certificate of the authority, DER.
    pub certificate: Vec<u8>,
    pub pem: String,
}

impl Authority {
    pub fn new(name: &str) -> Self {
        let mut params = rcgen::CertificateParams::default();
        params.distinguished_name.push(rcgen::DnType::CommonName, name);
        params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
        params.key_usages =
            vec![rcgen::KeyUsagePurpose::KeyCertSign, rcgen::KeyUsagePurpose::CrlSign];
        let key = rcgen::KeyPair::generate().unwrap();
        let certificate = params.self_signed(&key).unwrap();
        let (pem, certificate) = (certificate.pem(), certificate.der().to_vec());
        Self { issuer: rcgen::Issuer::new(params, key), certificate, pem }
    }

    /// Writes a key and a certificate with this serial number to the folder of a client.
    pub fn issue(&self, folder: &std::path::Path, serial: u64) {
        let key = opcua_stack::opcua::crypto::PrivateKey::new(2048).unwrap().to_der().unwrap();
        let key = rcgen::KeyPair::try_from(key.as_bytes()).unwrap();
        let mut params = rcgen::CertificateParams::new(vec!["localhost".to_owned()]).unwrap();
        params.distinguished_name.push(rcgen::DnType::CommonName, format!("client {serial}"));
        params.serial_number = Some(serial.into());
        params
            .subject_alt_names
            .insert(0, rcgen::SanType::URI("urn:verbund:test:client".try_into().unwrap()));
        params.key_usages =
            vec![rcgen::KeyUsagePurpose::DigitalSignature, rcgen::KeyUsagePurpose::KeyEncipherment];
        let certificate = params.signed_by(&key, &self.issuer).unwrap();
        for name in ["own", "private"] {
            std::fs::create_dir_all(folder.join(name)).unwrap();
        }
        std::fs::write(folder.join("own/cert.der"), certificate.der()).unwrap();
        std::fs::write(folder.join("private/private.pem"), key.serialize_pem()).unwrap();
    }

    /// Signs a revocation list that is valid from this year on.
    pub fn revocation_list(&self, serials: &[u64]) -> Vec<u8> {
        self.revocation_list_of(serials, 2026, 2096)
    }

    /// Signs a revocation list that is valid from the beginning of one year to that of another.
    pub fn revocation_list_of(
        &self,
        serials: &[u64],
        this_update: i32,
        next_update: i32,
    ) -> Vec<u8> {
        let revoked = serials.iter().map(|serial| rcgen::RevokedCertParams {
            serial_number: (*serial).into(),
            revocation_time: rcgen::date_time_ymd(this_update, 1, 1),
            reason_code: None,
            invalidity_date: None,
        });
        let params = rcgen::CertificateRevocationListParams {
            this_update: rcgen::date_time_ymd(this_update, 1, 1),
            next_update: rcgen::date_time_ymd(next_update, 1, 1),
            crl_number: 1_u64.into(),
            issuing_distribution_point: None,
            revoked_certs: revoked.collect(),
            key_identifier_method: rcgen::KeyIdMethod::Sha256,
        };
        params.signed_by(&self.issuer).unwrap().der().to_vec()
    }
}
